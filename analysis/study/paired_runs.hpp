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

/// Indices (left, right) of the numbers that two increasing lists share.
std::vector<std::pair<std::size_t, std::size_t>> common_places(
    std::span<const std::uint64_t> left, std::span<const std::uint64_t> right);

/// Returns whether two scores differ by rounding alone: then they are a tie.
bool are_equal(double a, double b);

/// Runs of two cells in the same worlds. A cell has no value in a run that failed or that has no
/// finite score; such a run is won by the other cell if that has a value.
struct PairedRuns {
  std::vector<double> left, right;  ///< values of the runs in which both cells have one, in order
  std::size_t left_alone = 0;       ///< number of runs in which only `left` has a value: it wins
  std::size_t right_alone = 0;
  std::size_t neither = 0;   ///< number of runs that ended in both cells without a value: tied
  std::size_t unpaired = 0;  ///< number of runs that ended in only one of the two cells

  std::size_t ended() const { return left.size() + left_alone + right_alone + neither; }
  /// Left minus right, for each run in which both have a value; 0 where they are equal.
  std::vector<double> differences() const;
};

PairedRuns paired_runs(const CellAnalysis& left, const CellAnalysis& right, const Score& score);

/// Returns whether any run of the cell has a finite value.
bool has_score(const CellAnalysis& cell, const Score& score);

/// Returns whether the score applies to the cell: a run has a finite value, or all runs failed.
/// EKF-SLAM, for instance, has no effective particles.
bool is_judged_by(const CellAnalysis& cell, const Score& score);

}  // namespace montecarta::analysis
