// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/path_at_fixes.hpp"

#include <Eigen/Core>

#include <cmath>
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

}  // namespace montecarta::analysis
