// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/study_analysis.hpp"

#include <filesystem>

namespace montecarta {

/// One row a scan: the Cramer-Rao bound of position and heading.
void write_bound(const StudyAnalysis& study, const std::filesystem::path& path);

/// One row a cell and landmark: error and NEES over runs, with the bounds of that NEES.
void write_landmarks(const StudyAnalysis& study, const std::filesystem::path& path);

}  // namespace montecarta
