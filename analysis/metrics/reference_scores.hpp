// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/drive_scores.hpp"
#include "analysis/statistics/spread.hpp"

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// A turn of the plane and then a shift: neither stretches nor mirrors.
struct RigidMotion {
  double angle = 0.0;                               ///< [rad] counter-clockwise
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();  ///< [m]

  Eigen::Vector2d operator()(const Eigen::Vector2d& point) const;
};

/// The rigid motion that brings the points `from` [m] nearest to the points `onto` [m], pair by
/// pair, in the sum of squared distances: in the plane in closed form (Umeyama 1991 without scale).
/// One point is only shifted, none stays where it is.
RigidMotion rigid_alignment(std::span<const Eigen::Vector2d> from,
                            std::span<const Eigen::Vector2d> onto);

/// A fix counts for gated numbers where its error is at most so many times the run's own median
/// error: a GPS fix may be 136 m off. To be read with the share: a filter that leaves the path half
/// way keeps few fixes.
inline constexpr double kReferenceGate = 4.0;
/// A run has lost the map where the median of its aligned errors is larger [m].
inline constexpr double kLostBeyond = 10.0;

/// How far the estimate of one run is from the fixes of a reference (STATISTICS 16). The
/// distances are raw, or aligned: after the rigid motion that brings the estimate nearest to all
/// fixes, which takes away what nobody knows of the start's position and heading. NaN of no fixes.
struct ReferenceScores {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  double rms = kNone;                  ///< [m] raw
  double median = kNone;               ///< [m] raw
  double gated_rms = kNone;            ///< [m] raw, over fixes within kReferenceGate medians
  double gated_share = kNone;          ///< [1] of fixes within
  double aligned_rms = kNone;          ///< [m]
  double aligned_median = kNone;       ///< [m]
  double aligned_gated_rms = kNone;    ///< [m]
  double aligned_gated_share = kNone;  ///< [1]
  double heading_rmse = kNone;         ///< [rad] raw; NaN where the reference has no heading

  /// Also where estimates are no numbers: of those 0 are within the gate.
  bool has_fixes() const { return !std::isnan(rms) || !std::isnan(gated_share); }
  bool lost() const { return !(aligned_median <= kLostBeyond); }
};

/// One run against one reference.
struct ReferenceRun {
  ReferenceScores scores;
  std::vector<double> squared_error;  ///< [m^2] {fix} raw
  RigidMotion alignment;              ///< of the path onto the fixes
};

/// `path` {row, 3} [m, m, rad] over the rows that `fixes` were made for.
ReferenceRun measure_against(const PathAtFixes& fixes, std::span<const double> path);

/// The complete runs of a cell against one reference.
struct ReferenceAnalysis {
  std::vector<ReferenceScores> runs;  ///< {run}
  /// [m] {fix} raw distance, RMS over runs; empty where runs are drives of their own.
  std::vector<double> error_over_time;

  /// Of the runs with fixes.
  Spread over_runs(double ReferenceScores::*score) const;
  /// How many runs have fixes: drives of their own may have none.
  std::size_t with_fixes() const;
  /// Runs that lost the map.
  std::size_t lost() const;
  /// Runs whose `score` is below `baseline` [m].
  std::size_t better_than(double baseline, double ReferenceScores::*score) const;
};

/// One for each reference of the drive, the leading first.
using ReferenceAnalyses = std::vector<ReferenceAnalysis>;

/// Adds up runs against one reference in the order of the calls. Memory depends on fixes, and grows
/// by a few numbers with every run.
class ReferenceAccumulator {
 public:
  /// `fixes`: of runs that all met the same; else their errors are not added up fix by fix.
  enum class Fixes { same, own };
  explicit ReferenceAccumulator(Fixes fixes = Fixes::same) : fixes_(fixes) {}
  void add(const ReferenceRun& run);
  ReferenceAnalysis result() const;

 private:
  Fixes fixes_;
  std::vector<ReferenceScores> runs_;
  std::vector<double> squared_;  ///< [m^2] {fix} sum over runs
};

}  // namespace montecarta::analysis
