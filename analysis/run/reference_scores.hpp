// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/path_at_fixes.hpp"
#include "analysis/statistics/spread.hpp"

#include <Eigen/Core>

#include <cmath>
#include <span>
#include <tuple>
#include <vector>

namespace montecarta::analysis {

/// A rotation of the plane followed by a translation.
struct RigidMotion {
  double angle = 0.0;                               ///< [rad] counter-clockwise
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();  ///< [m] translation

  Eigen::Vector2d operator()(const Eigen::Vector2d& point) const;
};

/// The rigid motion that minimises the sum of squared distances between pairs of the points `from`
/// [m] and `onto` [m], in closed form (Umeyama 1991 without scale). One point is only shifted;
/// without points it is the identity.
RigidMotion rigid_alignment(std::span<const Eigen::Vector2d> from,
                            std::span<const Eigen::Vector2d> onto);

/// Gated numbers use the fixes whose error is at most this many times the run's own median error,
/// since a GPS fix may be 136 m off. They must be read with the share of fixes kept: a filter that
/// leaves the path half way keeps few.
inline constexpr double kReferenceGate = 4.0;

/// A run has lost the map if the median of its aligned errors is larger than this [m].
inline constexpr double kLostBeyond = 10.0;

/// Distances between the estimate of one run and the fixes of a reference (STATISTICS 16), raw or
/// aligned. Aligned distances are taken after the rigid motion that brings the estimate nearest to
/// all fixes, which removes the unknown error of the start's position and heading. NaN without
/// fixes.
struct ReferenceScores {
  double rms = kNaN;             ///< [m] RMS of the raw distances
  double median = kNaN;          ///< [m] median of the raw distances
  double gated_rms = kNaN;       ///< [m] RMS of the raw distances within kReferenceGate medians
  double gated_share = kNaN;     ///< [1] share of the raw distances within kReferenceGate medians
  double aligned_rms = kNaN;     ///< [m] RMS of the aligned distances
  double aligned_median = kNaN;  ///< [m] median of the aligned distances
  /// [m] RMS of the aligned distances within kReferenceGate medians.
  double aligned_gated_rms = kNaN;
  /// [1] share of the aligned distances within kReferenceGate medians.
  double aligned_gated_share = kNaN;
  double heading_rmse = kNaN;  ///< [rad] RMS raw heading error; NaN if the reference has no heading

  static constexpr auto members() {
    using Scores = ReferenceScores;
    return std::tuple(&Scores::rms, &Scores::median, &Scores::gated_rms, &Scores::gated_share,
                      &Scores::aligned_rms, &Scores::aligned_median, &Scores::aligned_gated_rms,
                      &Scores::aligned_gated_share, &Scores::heading_rmse);
  }

  /// Returns whether there are fixes, also if estimates are not finite: gated_share is then 0.
  bool has_fixes() const { return !std::isnan(rms) || !std::isnan(gated_share); }
  bool lost() const { return !(aligned_median <= kLostBeyond); }
};

/// Comparison of one run with one reference.
struct ReferenceRun {
  ReferenceScores scores;
  std::vector<double> squared_error;  ///< [m^2] {fix} raw squared distance
  RigidMotion alignment;              ///< motion that aligns the path with the fixes
};

/// Compares a path {row, 3} [m, m, rad] with `fixes`, which were made for its rows.
ReferenceRun measure_against(const PathAtFixes& fixes, std::span<const double> path);

}  // namespace montecarta::analysis
