// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/cell_analysis.hpp"
#include "analysis/study/score_table.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace montecarta::analysis {

/// Places (left, right) of the numbers that two increasing lists share.
std::vector<std::pair<std::size_t, std::size_t>> common_places(
    std::span<const std::uint64_t> left, std::span<const std::uint64_t> right);

/// Runs of two cells in the same worlds. A cell has no value in a run that failed or that has no
/// finite score; it then loses to a cell that has a value.
struct PairedRuns {
  std::vector<double> left, right;  ///< of each run in which both have a value, in order
  std::size_t left_alone = 0;       ///< runs in which only `left` has a value: it wins
  std::size_t right_alone = 0;
  std::size_t neither = 0;   ///< ended in both cells, without a value in either: tied
  std::size_t unpaired = 0;  ///< ended in one of the two cells only

  std::size_t ended() const { return left.size() + left_alone + right_alone + neither; }
  /// Left minus right, of each run in which both have a value.
  std::vector<double> differences() const;
};

PairedRuns paired_runs(const CellAnalysis& left, const CellAnalysis& right, const Score& score);

/// Whether any run of the cell has a finite value.
bool has_score(const CellAnalysis& cell, const Score& score);

/// Whether the score applies to the cell: whether a run has a finite value, or all runs failed.
/// EKF-SLAM, for instance, has no effective particles.
bool is_judged_by(const CellAnalysis& cell, const Score& score);

}  // namespace montecarta::analysis
