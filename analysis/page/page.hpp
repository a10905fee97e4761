// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/study_analysis.hpp"
#include "analysis/output/section.hpp"

#include <filesystem>
#include <vector>

namespace montecarta::analysis {

/// Writes index.html with these sections in their order, their figures below figures/ and data/ and
/// their tables below tables/ into `directory`.
void write_page(const StudyAnalysis& study, const std::vector<Section>& sections,
                const std::filesystem::path& directory);

}  // namespace montecarta::analysis
