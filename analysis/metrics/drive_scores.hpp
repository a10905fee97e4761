// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/fix_errors.hpp"
#include "analysis/statistics/correlated_average.hpp"

#include <array>
#include <cstddef>
#include <limits>
#include <span>

namespace montecarta::analysis {

/// One run of a filter on one drive by a reference whose errors are known (STATISTICS 20).
struct DriveScores {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  /// {ErrorBlock} NEES at the fixes; effective_samples 0 where the block is not measured.
  std::array<CorrelatedAverage, kErrorBlocks.size()> blocks;
  /// {ErrorBlock} what those are of; empty where the block is not measured.
  std::array<VectorSeries, kErrorBlocks.size()> errors;
  ErrorBlock leading = ErrorBlock::pose;  ///< the pose where there are headings, else the position
  double median = kNone;                  ///< of the leading NEES, over that of a chi-square
  double seconds = 0.0;                   ///< from the first fix judged to the last
  std::size_t fixes = 0;                  ///< judged
  std::size_t in_gaps = 0;    ///< left out: scans around lie farther apart than kLongestScanGap
  std::size_t undefined = 0;  ///< left out: no finite covariance, or too few draws
  /// The estimate is the reference itself: at no fix it differs by a thousandth of the fix's sigma.
  bool is_the_reference = false;
  /// Errors are shown to be smaller than the fixes' own: their sigmas are too large, or the
  /// reference fed the filter.
  bool is_below_reference = false;

  const CorrelatedAverage& leads() const { return blocks[static_cast<std::size_t>(leading)]; }
};

/// As errors_at_fixes(), all blocks; `level` of the intervals.
DriveScores drive_scores(const PathAtFixes& fixes, std::span<const double> scan_times,
                         const RunRows& rows, std::size_t particles, double level);

}  // namespace montecarta::analysis
