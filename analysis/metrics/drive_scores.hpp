// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/data/run_rows.hpp"
#include "analysis/metrics/moments.hpp"
#include "analysis/metrics/path_at_fixes.hpp"
#include "analysis/statistics/correlated_average.hpp"
#include "analysis/statistics/correlation.hpp"

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// A fix is judged where the scans before and after it lie at most so far apart [s]: mean and
/// covariance are interpolated linearly between them.
inline constexpr double kLongestScanGap = 1.0;

/// Errors of one run at the fixes of a reference whose own errors are known (STATISTICS 20).
struct FixErrors {
  /// {component}{fix judged} in units of P + R, the filter's covariance and that of the fix: their
  /// squares add up to the NEES, of particle filters on the scale of the chi-square.
  VectorSeries whitened;
  VectorSeries by_reference;  ///< likewise in units of R alone
  std::vector<double> nees;   ///< {fix judged}
  std::vector<double> times;  ///< [s] of the fixes judged
  std::size_t in_gaps = 0;    ///< fixes left out: scans around lie farther apart
  std::size_t undefined = 0;  ///< fixes left out: no finite covariance, or too few draws
};

/// `fixes` of the scans at `scan_times` [s], with their covariances, against the leading moments of
/// `rows`, of a filter with `particles` (0: none). Nothing where no covariance is stored, or the
/// reference does not measure the block.
FixErrors errors_at_fixes(const PathAtFixes& fixes, std::span<const double> scan_times,
                          const RunRows& rows, std::size_t particles, ErrorBlock block);

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
