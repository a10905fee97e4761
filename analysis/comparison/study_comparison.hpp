// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/comparison/cell_comparison.hpp"
#include "analysis/metrics/verdict_table.hpp"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// What is said of the cells beside each other, whoever it is said to.
struct StudyComparison {
  Comparisons comparisons;
  std::vector<WinMatrix> matrices;  ///< {score} that two cells or more are judged by
};

StudyComparison compare_study(const StudyAnalysis& study, const std::string& baseline,
                              std::span<const Score* const> scores);

/// Names of the files that write_comparison_csv() makes.
std::vector<std::string> comparison_csv_names();

/// Writes comparison.csv (one row a cell and score) and wins.csv (one row a score and ordered pair
/// of cells) into `directory`, which is made where it is missing. Throws RunError naming the file
/// that cannot be written.
void write_comparison_csv(const StudyComparison& comparison,
                          const std::filesystem::path& directory);

/// One row a cell and score: the difference from the baseline and its tests.
TextTable comparison_table(const Comparisons& comparisons);
/// One row and one column a cell: in what share of runs the row beats the column.
TextTable win_table(const WinMatrix& matrix, double level);

/// Each table's meaning, a sentence each, for someone who never heard of a p value.
std::vector<std::string> comparison_notes(const StudyAnalysis& study,
                                          const Comparisons& comparisons);
std::string win_note(double level);

}  // namespace montecarta::analysis
