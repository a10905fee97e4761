// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/run_average.hpp"
#include "analysis/statistics/whole_run_band.hpp"

#include <cstdint>
#include <functional>

namespace montecarta::analysis {

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
