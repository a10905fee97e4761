// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/spread.hpp"
#include "analysis/statistics/sums.hpp"
#include "analysis/verdict/verdict.hpp"

#include <cstddef>
#include <span>
#include <tuple>
#include <vector>

namespace montecarta::analysis {

/// Compares the errors of different runs in groups of eight successive runs. Products of errors of
/// two runs show how much sums of squares of Gaussian errors vary, whatever the memory is
/// (STATISTICS 5); sums that vary more have scales of their own, or tails. Groups are independent
/// of each other. A group that has fewer than eight runs when its block of runs ends is left out.
class RunGroups {
 public:
  static constexpr std::size_t kRuns = 8;
  /// The fewest groups that are judged.
  static constexpr std::size_t kFewestGroups = 6;

  RunGroups() = default;  ///< empty sums, to be filled by a SumReader
  /// Makes sums for errors of `dimension` components; `ends` {stretch} is 1 + the last scan of each
  /// stretch.
  RunGroups(std::size_t dimension, std::vector<std::size_t> ends);

  /// Adds the whitened errors {scan, component} of the next run; NaN where there is none.
  void add(std::span<const double> whitened);
  /// Adds the tests of the families `between_runs` and `tails` if there are enough groups for them.
  void add_tests(std::vector<MemberTest>& all) const;
  static constexpr auto parts() {
    return std::tuple(added(&RunGroups::spread_, &RunGroups::spread_unit_, &RunGroups::tails_,
                            &RunGroups::tails_unit_));
  }

 private:
  void end_group();
  void blank_incomplete();
  void add_spread();
  void add_tails();
  /// {part} Sums of the products of two runs over the scans of a part: one component in one
  /// stretch.
  std::vector<double> products(std::size_t i, std::size_t j) const;
  /// Sum of x_A y_B over parts A and B that have nothing in common.
  double of_different_parts(std::span<const double> x, std::span<const double> y) const;

  std::size_t dimension_ = 0;
  std::vector<std::size_t> ends_;
  std::vector<std::vector<double>> group_;  ///< {run of the group}{scan, component} whitened errors
  SummaryOf spread_, spread_unit_;          ///< summaries over groups of sums over parts
  SummaryOf tails_, tails_unit_;            ///< summaries over groups of means over errors
};

}  // namespace montecarta::analysis
