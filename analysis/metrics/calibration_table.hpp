// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/study_analysis.hpp"
#include "analysis/metrics/verdict_table.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace montecarta {

/// Whether any cell has histograms to judge.
bool has_calibration(const StudyAnalysis& study);

/// One row a cell and way of judging: the verdicts at the end of the run, and in how many of all
/// tests of all moments there is another verdict than calibrated. Without rows where nothing is
/// judged.
TextTable calibration_table(const StudyAnalysis& study);

/// How to read it, a sentence each; none where there is no table.
std::vector<std::string> calibration_notes(const StudyAnalysis& study);

/// One row a histogram: its counts with their band, mean, variance and verdict.
void write_calibration(const StudyAnalysis& study, const std::filesystem::path& path);

}  // namespace montecarta
