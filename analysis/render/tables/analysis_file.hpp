// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/study_analysis.hpp"

#include <filesystem>

namespace montecarta::analysis {

/// Writes all results of the analysis as HDF5: one group for each cell below /cells, with series
/// over the scale `time`. Replaces `path` when all is written. Throws RunError if that fails, and
/// leaves the old file.
void write_analysis_file(const StudyAnalysis& study, const std::filesystem::path& path);

}  // namespace montecarta::analysis
