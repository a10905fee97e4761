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

/// NEES of one definition of error and covariance over scans and runs.
struct NeesSeries {
  std::size_t dimension = 0;
  std::vector<double> average;       ///< {scan} over valid runs; NaN where there is none
  std::vector<std::uint32_t> runs;   ///< {scan} valid: complete, with a finite NEES
  std::vector<Interval> bounds;      ///< {scan} of the average of a consistent filter at that scan
  std::vector<double> run_averages;  ///< {run} over its scans, of runs that have any NEES
  std::uint64_t samples = 0;         ///< scans x complete runs
  std::uint64_t lower_rank = 0;      ///< of them: judged in the range of a singular covariance
  std::uint64_t unusable = 0;  ///< of them: error or covariance is not finite, or the covariance
                               ///< not positive semidefinite; left out of the average
  std::uint64_t too_few = 0;   ///< of them: too few effective draws to be judged, left out as well
  std::uint64_t unjudged_runs = 0;  ///< complete runs without a NEES at any scan, left out as well
};

/// A NEES series in a few numbers.
struct NeesResult {
  ErrorBlock block = ErrorBlock::pose;
  Moments moments = Moments::spread;
  NeesSeries series;
  double mean = kNaN;              ///< of series.run_averages
  Interval average_interval = {};  ///< of the mean over infinitely many runs
  double share_above = 0.0;        ///< of scans with a valid run: above the bounds of a scan
  double share_below = 0.0;        ///< below them

  double share_inside() const { return 1.0 - share_above - share_below; }
  bool is_tested() const { return !std::isnan(mean); }
};

}  // namespace montecarta::analysis
