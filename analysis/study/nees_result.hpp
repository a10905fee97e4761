// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/nees.hpp"
#include "analysis/statistics/interval.hpp"
#include "analysis/statistics/spread.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace montecarta::analysis {

/// NEES of one definition of error and covariance over scans and runs. A run is valid at a scan if
/// it is complete and its NEES there is finite.
struct NeesSeries {
  std::size_t dimension = 0;
  std::vector<double> average;      ///< {scan} mean NEES over the valid runs; NaN if there are none
  std::vector<std::uint32_t> runs;  ///< {scan} number of valid runs
  /// {scan} bounds of the average of a consistent filter at that scan.
  std::vector<Interval> bounds;
  std::vector<double> run_averages;  ///< {run with a NEES} mean over its scans
  std::uint64_t samples = 0;         ///< number of samples of complete runs, without missing ones
  std::uint64_t missing = 0;         ///< number of scans of complete runs without an estimate
  /// Number of samples with a singular covariance, judged in its range. Samples of rank 0 have no
  /// NEES and are left out.
  std::uint64_t lower_rank = 0;
  /// Number of samples left out of the average because error or covariance is not finite, or
  /// because the covariance is not positive semidefinite.
  std::uint64_t unusable = 0;
  /// Number of samples left out because there are too few effective draws.
  std::uint64_t too_few = 0;
  /// Number of complete runs without a NEES at any scan, left out.
  std::uint64_t unjudged_runs = 0;
};

/// A NEES series in a few numbers.
struct NeesResult {
  ErrorBlock block = ErrorBlock::pose;
  Moments moments = Moments::spread;
  NeesSeries series;
  double mean = kNaN;  ///< mean of series.run_averages
  /// Interval of the mean over infinitely many runs (STATISTICS 5.1); NaN for fewer than three
  /// runs.
  Interval average_interval = {};
  /// Share of the scans with a valid run whose average is above the bounds.
  double share_above = 0.0;
  double share_below = 0.0;  ///< share of those scans whose average is below the bounds

  double share_inside() const { return 1.0 - share_above - share_below; }
  bool is_tested() const { return !std::isnan(mean); }
};

}  // namespace montecarta::analysis
