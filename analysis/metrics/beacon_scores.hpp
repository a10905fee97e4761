// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/rigid_alignment.hpp"

#include <Eigen/Core>

#include <limits>
#include <span>

namespace montecarta::analysis {

/// A surveyed beacon is found where an aligned landmark lies within this distance [m].
inline constexpr double kFoundWithin = 1.0;

/// A run's final map against beacons whose positions were surveyed. NaN where nothing was found.
struct BeaconScores {
  double found = 0.0;                                             ///< [1] beacons
  double rms = std::numeric_limits<double>::quiet_NaN();          ///< [m] of those found
  double aligned_rms = std::numeric_limits<double>::quiet_NaN();  ///< [m] of those found, aligned
};

/// Pairs each beacon [m] with the nearest landmark of `map` [m] after `alignment`, the motion that
/// brings the path onto its reference: where a drive began nobody knows exactly. A landmark counts
/// for one beacon only, the nearer pair first.
BeaconScores beacon_scores(std::span<const Eigen::Vector2d> map,
                           std::span<const Eigen::Vector2d> beacons, const RigidMotion& alignment);

}  // namespace montecarta::analysis
