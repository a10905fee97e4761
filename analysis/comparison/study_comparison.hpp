// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/comparison/cell_comparison.hpp"
#include "analysis/comparison/pareto.hpp"
#include "analysis/comparison/win_matrix.hpp"

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

}  // namespace montecarta::analysis
