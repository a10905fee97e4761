// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/data/run_rows.hpp"
#include "analysis/metrics/nees.hpp"
#include "analysis/statistics/correlated_average.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/verdict/verdict.hpp"
#include "engine/core/drive.hpp"
#include "engine/core/pose.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace montecarta::analysis {

/// The fixes of a reference that lie within a drive's time span, and where each lies between the
/// rows of an estimated path. The same for all runs of all cells; any number of threads may use it.
class PathAtFixes {
 public:
  /// `times` [s] of a path's rows, increasing; the vehicle stands at `start` at time 0. Fixes
  /// before that or behind the last row are not used.
  PathAtFixes(const ReferencePath& reference, std::span<const double> times, const Pose& start);

  const std::string& name() const { return used_.name; }
  /// [s] of each fix that is used.
  const std::vector<double>& times() const { return used_.time; }
  /// [m]
  const std::vector<Eigen::Vector2d>& positions() const { return used_.position; }
  /// [rad]; empty where the reference has none.
  const std::vector<double>& headings() const { return used_.heading; }

  /// (m, m, rad)^2 of each fix; empty if unknown.
  const std::vector<Eigen::Matrix3d>& covariances() const { return used_.covariance; }

  /// Between row `next` - 1 (the start for 0) and row `next`.
  struct Place {
    std::size_t next = 0;
    double share = 0.0;  ///< of the way, in [0, 1]
  };
  /// The place of each fix.
  const std::vector<Place>& places() const { return places_; }
  /// Whether the start was taken from a fix: whether the two agree to a micrometre.
  bool has_start() const;

  /// `path` {row, 3} [m, m, rad], linearly in time at every fix; the heading turns the shorter way.
  std::vector<Pose> interpolate(std::span<const double> path) const;

 private:
  static Place place_of(double time, std::span<const double> times);

  Pose start_;
  ReferencePath used_;
  std::vector<Place> places_;
};

/// The longest gap [s] between the scans before and after a fix that is judged, because mean and
/// covariance are interpolated linearly between them.
inline constexpr double kLongestScanGap = 1.0;

/// Errors of one run at the fixes of a reference with known errors (STATISTICS 20).
struct FixErrors {
  /// {component}{fix judged} in units of P + R, the covariance of the filter plus that of the fix.
  /// The sum of squares is the NEES; for particle filters it is on the scale of the chi-square.
  VectorSeries whitened;
  VectorSeries by_reference;  ///< likewise in units of R alone
  std::vector<double> nees;   ///< {fix judged}
  std::vector<double> times;  ///< [s] of the fixes judged
  std::size_t in_gaps = 0;    ///< fixes left out: scans around lie farther apart
  std::size_t undefined = 0;  ///< fixes left out: no finite covariance, or too few draws
};

/// Errors at `fixes`, which belong to the scans at `scan_times` [s], by the leading moments of
/// `rows` of a filter with `particles` (0: none). Empty if no covariance is stored or if the
/// reference does not measure the block.
FixErrors errors_at_fixes(const PathAtFixes& fixes, std::span<const double> scan_times,
                          const RunRows& rows, std::size_t particles, ErrorBlock block);

/// Scores of one run on one drive by a reference with known errors (STATISTICS 20).
struct DriveScores {
  /// {ErrorBlock} NEES at the fixes; effective_samples 0 where the block is not measured.
  std::array<CorrelatedAverage, kErrorBlocks.size()> blocks;
  /// {ErrorBlock} whitened errors; empty where the block is not measured.
  std::array<VectorSeries, kErrorBlocks.size()> errors;
  ErrorBlock leading = ErrorBlock::pose;  ///< the pose where there are headings, else the position
  double median = kNaN;                   ///< of the leading NEES, over that of a chi-square
  double seconds = 0.0;                   ///< from the first fix judged to the last
  std::size_t fixes = 0;                  ///< judged
  std::size_t in_gaps = 0;    ///< left out: scans around lie farther apart than kLongestScanGap
  std::size_t undefined = 0;  ///< left out: no finite covariance, or too few draws
  /// The estimate is the reference itself: at no fix it differs by a thousandth of the fix's sigma.
  bool is_the_reference = false;
  /// Errors are shown to be smaller than the fixes' own: their sigmas are too large, or the
  /// reference was an input of the filter.
  bool is_below_reference = false;

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
DriveScores drive_scores(const PathAtFixes& fixes, std::span<const double> scan_times,
                         const RunRows& rows, std::size_t particles, double level);

/// Verdict on a cell by one reference. Runs on the same drive differ by the filter's random numbers
/// alone, so many say no more about the drive than one; runs on drives of their own are
/// independent.
struct DriveConsistency {
  Answer answer = Answer::untested;
  double within = kUsualMargin;
  DriveScores mean;        ///< means over runs; of counts and flags the largest
  double minutes = 0.0;    ///< of such driving after which the verdict is decided; may be infinite
  std::size_t drives = 0;  ///< drives that were judged; 0: all runs process one drive
};

/// Judges runs of one cell on the same drive. Untested if there are no runs, if no fix can be
/// judged, or if the estimate is the reference itself.
DriveConsistency judge_drive(std::span<const DriveScores> runs, double level, double within);

/// Judges runs on drives of their own, with DriveScores::errors. In `mean`, fixes, seconds and
/// counts are sums. Drives without a fix that can be judged are left out.
DriveConsistency judge_own_drives(std::span<const DriveScores> runs, double level, double within);

/// "consistent within 1.1", "optimistic by 1.3 to 2.1", "this drive cannot tell: it would need 40
/// minutes", ...
std::string in_words(const DriveConsistency& drive);

}  // namespace montecarta::analysis
