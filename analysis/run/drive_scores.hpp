// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/nees.hpp"
#include "analysis/run/path_at_fixes.hpp"
#include "analysis/run/run_rows.hpp"
#include "analysis/statistics/correlated_average.hpp"
#include "analysis/statistics/spread.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

namespace montecarta::analysis {

/// Errors of one run at the fixes of a reference with known errors (STATISTICS 20).
struct FixErrors {
  /// {component}{fix judged} errors in units of P + R, the covariance of the filter plus that of
  /// the fix. The sum of squares is the NEES; for particle filters it is on the scale of the
  /// chi-square.
  VectorSeries whitened;
  VectorSeries by_reference;            ///< {component}{fix judged} errors in units of R alone
  std::vector<double> nees;             ///< {fix judged} NEES
  std::vector<double> log_determinant;  ///< {fix judged} logarithm of the determinant of P + R
  std::vector<double> times;            ///< [s] {fix judged} time of each fix
  std::size_t undefined = 0;  ///< number of fixes left out: no finite covariance, or too few draws
};

/// Errors at `fixes` by the leading moments of RunRows::path, of a filter with `particles` (0: not
/// a particle filter). `scan_rows` {scan} are the rows of the scans; empty if rows are scans. Empty
/// if no covariance is stored or if the reference does not measure the block.
FixErrors errors_at_fixes(const PathAtFixes& fixes, std::span<const std::uint32_t> scan_rows,
                          const RunRows& rows, std::size_t particles, ErrorBlock block);

/// A fix is a gross outlier if its error is more than this many standard deviations, on the scale
/// of the median: if its NEES is more than the square of it times the median over expectation.
inline constexpr double kGrossDeviations = 10.0;

/// Scores of one run on one drive by a reference with known errors (STATISTICS 20).
struct DriveScores {
  /// {ErrorBlock} test of the NEES at the fixes; effective_samples is 0 if the block is not
  /// measured.
  std::array<CorrelatedAverage, kErrorBlocks.size()> blocks;
  /// {ErrorBlock} whitened errors; empty if the block is not measured.
  std::array<VectorSeries, kErrorBlocks.size()> errors;
  /// Block that is judged: the pose if fixes have headings, else the position.
  ErrorBlock leading = ErrorBlock::pose;
  double median = kNaN;       ///< median of the leading NEES divided by that of a chi-square
  double seconds = 0.0;       ///< [s] time from the first fix judged to the last
  std::size_t fixes = 0;      ///< number of fixes judged
  std::size_t in_gaps = 0;    ///< number of fixes left out: PathAtFixes::in_gaps()
  std::size_t undefined = 0;  ///< number of fixes left out: no finite covariance, or too few draws
  std::size_t outliers = 0;   ///< number of judged fixes that are gross outliers
  /// Mean of the leading NEES over its expectation, of all judged fixes but gross outliers.
  double ratio_without_outliers = kNaN;
  /// Whether the estimate is the reference itself: it differs from every fix by less than a
  /// thousandth of the fix's sigma.
  bool is_the_reference = false;
  /// Whether errors are shown to be smaller than the fixes' own: their sigmas are too large, or the
  /// reference was an input of the filter.
  bool is_below_reference = false;

  /// Without the numbers of outliers: files of sums hold no recorded drives, and those of older
  /// builds stay readable.
  static constexpr auto members() {
    using Scores = DriveScores;
    return std::tuple(&Scores::blocks, &Scores::errors, &Scores::leading, &Scores::median,
                      &Scores::seconds, &Scores::fixes, &Scores::in_gaps, &Scores::undefined,
                      &Scores::is_the_reference, &Scores::is_below_reference);
  }
  const CorrelatedAverage& leads() const { return blocks[static_cast<std::size_t>(leading)]; }
};

/// Scores of all blocks, with intervals at `level`; the other parameters are those of
/// errors_at_fixes().
DriveScores drive_scores(const PathAtFixes& fixes, std::span<const std::uint32_t> scan_rows,
                         const RunRows& rows, std::size_t particles, double level);

}  // namespace montecarta::analysis
