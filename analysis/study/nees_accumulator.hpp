// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/nees.hpp"
#include "analysis/run/run_metrics.hpp"
#include "analysis/statistics/sums.hpp"
#include "analysis/study/nees_result.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

namespace montecarta::analysis {

/// Adds up the NEES of one block by one definition of the moments over runs. Memory depends on the
/// scans, and grows by one number with every run.
class NeesAccumulator {
 public:
  NeesAccumulator() = default;  ///< empty sums, to be filled by a SumReader
  /// `dimension` is the number of components of the block; 0: dimension_of(block).
  NeesAccumulator(ErrorBlock block, Moments moments, std::size_t scans, std::size_t dimension = 0);
  Moments moments() const { return moments_; }
  void add(const RunMetrics& metrics);
  /// Adds a run: `value` {scan} is its NEES, NaN if it is unusable, `rank` {scan} that of its
  /// covariances (empty: all full), and `too_few` {scan} is 1 where there were too few draws to
  /// judge (empty: nowhere).
  void add(std::span<const double> value, std::span<const int> rank = {},
           std::span<const std::uint8_t> too_few = {});
  /// The result; `level` is that of the bounds and of the interval of the mean.
  NeesResult result(double level) const;
  static constexpr auto parts() {
    using Sums = NeesAccumulator;
    return std::tuple(settings(&Sums::block_, &Sums::moments_, &Sums::dimension_),
                      added(&Sums::sum_, &Sums::runs_, &Sums::samples_, &Sums::lower_rank_,
                            &Sums::unusable_, &Sums::too_few_, &Sums::unjudged_runs_),
                      appended(&Sums::run_averages_));
  }

 private:
  NeesSeries series(double level) const;
  Interval interval_of_mean(double level) const;

  ErrorBlock block_ = ErrorBlock::pose;
  Moments moments_ = Moments::spread;
  std::size_t dimension_ = 0;
  std::vector<double> sum_;           ///< {scan} sum of the finite NEES
  std::vector<std::uint32_t> runs_;   ///< {scan} number of runs in the sum
  std::vector<double> run_averages_;  ///< {run that has a NEES} average over its scans
  std::uint64_t samples_ = 0, lower_rank_ = 0, unusable_ = 0, too_few_ = 0, unjudged_runs_ = 0;
};

}  // namespace montecarta::analysis
