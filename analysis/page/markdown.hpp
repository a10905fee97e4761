// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/study_analysis.hpp"
#include "analysis/output/section.hpp"
#include "engine/records/result_description.hpp"

#include <string>
#include <vector>

namespace montecarta::analysis {

/// A table as Markdown, special characters escaped; numbers are set to the right.
std::string markdown_table(const TextTable& table);

/// A report in one short page of Markdown: the study, where and when it ran, failed runs, the
/// tables of the terminal, the first figure over time (figures/NAME.svg) and, where a paper is
/// repeated, its numbers beside the measured ones. `sections` in their order of reading.
std::string markdown_page(const StudyAnalysis& study, const std::vector<Section>& sections,
                          const TextPairs& provenance);

}  // namespace montecarta::analysis
