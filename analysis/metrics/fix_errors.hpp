// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/data/run_rows.hpp"
#include "analysis/metrics/moments.hpp"
#include "analysis/metrics/path_at_fixes.hpp"
#include "analysis/statistics/correlation.hpp"

#include <cstddef>
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

}  // namespace montecarta::analysis
