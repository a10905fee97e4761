// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/comparison/study_comparison.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// Names of the files that write_comparison_csv() makes.
std::vector<std::string> comparison_csv_names();

/// Writes comparison.csv (one row a cell and score), wins.csv (one row a score and ordered pair of
/// cells) and pareto.csv (one row a cell) into `directory`, which is made where it is missing.
/// Throws RunError naming the file that cannot be written.
void write_comparison_csv(const StudyComparison& comparison,
                          const std::filesystem::path& directory);

}  // namespace montecarta::analysis
