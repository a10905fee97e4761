// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"

#include <cstddef>
#include <numbers>
#include <span>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// Beams of one sweep of the laser of both recorded drives, half a degree apart: beam 0 points
/// right, 180 ahead, 360 left.
inline constexpr std::size_t kLaserBeams = 361;
/// A range from here on [m] says that nothing came back.
inline constexpr double kNoReturn = 80.0;

/// What the beams of one sweep measured, by beam: ranges [m] or intensities.
using LaserSweep = std::span<const double, kLaserBeams>;

/// Angle [rad] of a beam, counter-clockwise from the right; times pi before the division, as the
/// published codes have it: a detector's limits are whole beams, where the last bit decides.
inline double angle_of(std::size_t beam) {
  return static_cast<double>(beam) * std::numbers::pi / 360.0;
}

/// What one beam met.
struct Echo {
  double angle = 0.0;  ///< [rad], from the right
  double range = 0.0;  ///< [m]
};

/// Bearing [rad] relative to the heading of an angle from the right.
inline double bearing_of(double angle) { return angle - std::numbers::pi / 2; }

/// Throws StudyError, beginning with `place` (file and scan), unless each range is a number and not
/// negative.
void check_sweep(LaserSweep ranges, const std::string& place);

/// The trunks of trees in one sweep of ranges [m]: centre of the trunk, by increasing bearing, none
/// identified. The detector of every code on the Victoria Park data (J. Guivant, ACFR), step by
/// step as in [trees] of experiments/RECORDED_DRIVES.md.
std::vector<Detection> detect_trees(LaserSweep ranges);

/// The reflecting poles in one sweep of ranges [m] and intensities: centre of the pole, by
/// increasing bearing, none identified. See [reflectors] of experiments/RECORDED_DRIVES.md.
std::vector<Detection> detect_reflectors(LaserSweep ranges, LaserSweep intensities);

}  // namespace montecarta::experiments
