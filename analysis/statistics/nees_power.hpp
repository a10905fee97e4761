// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/nees_bounds.hpp"
#include "analysis/statistics/whole_run_band.hpp"

#include <cstdint>
#include <functional>
#include <span>

namespace montecarta::analysis {

/// How the average over runs of independent run averages is distributed, in units of its
/// expectation: a gamma whose skewness is corrected (STATISTICS 5).
struct AverageLaw {
  double variation = 0.0;  ///< squared coefficient of variation of one run's average
  double runs = 0.0;
  double deviate = 0.0;  ///< of the interval, in estimated deviations
  double skew = 1.0;     ///< skewness of one run's average in that of a gamma of its variance

  /// Where the average lies, expectation 1; [0, infinity] of fewer than three runs.
  Interval bounds() const;
};

/// Law of these run averages of a NEES of `dimension` components. Of a filter whose covariance is
/// off by one factor, 1 included, a run's average varies no more than a single scan: a larger
/// variation is cut to 2 / dimension.
AverageLaw average_law(std::span<const double> run_averages, std::size_t dimension, double deviate,
                       double skew);

/// Whether the run averages vary more than those of any such filter do by chance (three standard
/// errors of the logarithm of their variation): some runs are lost, others are not.
bool is_overdispersed(std::span<const double> run_averages, std::size_t dimension);

/// Ratios of the average to the expected one at which a study finds out with probability `power`
/// that they differ: the greatest below 1 and the least above 1.
Interval least_ratios(const AverageLaw& law, double power);

/// How many runs decide for certain whether the ratio is 1 or within [1 / within, within], if runs
/// go on to vary as they do: the interval of the ratio, in logarithms, is then no longer than
/// log(within), so that it excludes 1 or is inside. At most kMostDecidingRuns.
std::uint64_t runs_that_decide(AverageLaw law, double within);
inline constexpr std::uint64_t kMostDecidingRuns = 1'000'000'000;

/// Which study is planned for the verdict on an average NEES (STATISTICS 5).
struct NeesTest {
  std::uint64_t dimension = 3;  ///< of the error
  double level = 0.95;          ///< probability that a consistent filter is not rejected
  std::uint64_t scans = 1;      ///< independent ones in a run; 1: its NEES is as good as constant
};

/// What so many runs will say of a filter whose NEES is off by one factor at all scans, by the test
/// of the average over the run, which finds such a filter the sooner of the two.
class NeesPlan {
 public:
  /// Throws StudyError where `test` has no meaning: up to 100,000 scans.
  explicit NeesPlan(const NeesTest& test);

  /// Probability that `runs` runs show the ratio to differ from 1, on the side on which it does.
  double found(double ratio, std::uint64_t runs) const;
  /// Probability that `runs` runs show a consistent filter to be within [1 / within, within].
  double shown(double within, std::uint64_t runs) const;
  /// The fewest runs with at least this probability of either. Throws StudyError where the question
  /// has no meaning, or needs more than kMostPlannedRuns.
  std::uint64_t runs_to_find(double ratio, double power) const;
  std::uint64_t runs_to_show(double within, double power) const;
  /// The fewest runs that find any ratio to be within the margin, or to differ from 1.
  std::uint64_t runs_to_decide(double within) const;

 private:
  AverageLaw law(std::uint64_t runs) const;
  std::uint64_t fewest(const std::function<bool(std::uint64_t)>& is_enough) const;

  NeesTest test_;
  BandWalks walks_;
};
inline constexpr std::uint64_t kMostPlannedScans = 100'000;
inline constexpr std::uint64_t kMostPlannedRuns = 1'000'000'000;

}  // namespace montecarta::analysis
