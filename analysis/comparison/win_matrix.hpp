// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/comparison/cell_comparison.hpp"

#include <string>
#include <vector>

namespace montecarta::analysis {

/// Every cell against every other by one score.
struct WinMatrix {
  const Score* score = nullptr;
  std::vector<std::string> cells;       ///< that can be judged by the score
  std::vector<std::vector<Wins>> wins;  ///< {row, column}: of the row; empty on the diagonal
};

/// Tests are adjusted for all pairs of the matrix.
WinMatrix win_matrix(const StudyAnalysis& study, const Score& score);

}  // namespace montecarta::analysis
