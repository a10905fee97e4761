// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/comparison/cell_comparison.hpp"
#include "analysis/comparison/pareto.hpp"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// What is said of the cells beside each other, whoever it is said to.
struct StudyComparison {
  Comparisons comparisons;
  std::vector<WinMatrix> matrices;  ///< {score} that two cells or more are judged by
  std::vector<CellValue> values;    ///< empty where nobody knows the true path
};

StudyComparison compare_study(const StudyAnalysis& study, const std::string& baseline,
                              std::span<const Score* const> scores);

/// Names of the files that write_comparison_csv() makes.
std::vector<std::string> comparison_csv_names();

/// Writes comparison.csv (one row a cell and score), wins.csv (one row a score and ordered pair of
/// cells) and pareto.csv (one row a cell) into `directory`, which is made where it is missing.
/// Throws RunError naming the file that cannot be written.
void write_comparison_csv(const StudyComparison& comparison,
                          const std::filesystem::path& directory);

}  // namespace montecarta::analysis
