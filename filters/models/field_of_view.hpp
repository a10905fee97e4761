// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/sensor.hpp"

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <span>

namespace montecarta::models {

/// A landmark in view, relative to the sensor.
struct InView {
  std::size_t landmark = 0;  ///< index of the landmark
  double dx = 0.0;           ///< [m] from the sensor, along the axes of the map
  double dy = 0.0;           ///< [m] from the sensor, along the axes of the map
  double range = 0.0;        ///< [m] distance from the sensor
  double heading = 0.0;      ///< [rad] heading of the sensor
};

/// The region in which a sensor detects landmarks: min_range <= range < max_range and strictly
/// within the angle of view (EQUATIONS 2).
class FieldOfView {
 public:
  /// `max_range` and `min_range` [m]; `angle` [rad] is the full angle, centred on the heading.
  FieldOfView(double max_range, double angle, const Mounting& mounting = {}, double min_range = 0.0)
      : max_range_(max_range),
        cos_half_(cosine_of_half(angle)),
        mounting_(mounting),
        min_range_(min_range) {}

  /// Calls visit(InView) for every landmark [m] in view from a vehicle at `vehicle`, in the order
  /// of `landmarks`.
  template <class Visit>
  void look(const Pose& vehicle, std::span<const Eigen::Vector2d> landmarks,
            const Visit& visit) const {
    const Pose pose = mounting_.pose_of(vehicle);
    const double cosine = std::cos(pose.heading);
    const double sine = std::sin(pose.heading);
    for (std::size_t i = 0; i < landmarks.size(); ++i) {
      const double dx = landmarks[i].x() - pose.x;
      const double dy = landmarks[i].y() - pose.y;
      const double squared = dx * dx + dy * dy;
      if (squared >= max_range_ * max_range_ || squared < min_range_ * min_range_) continue;
      const double range = std::sqrt(squared);
      if (dx * cosine + dy * sine <= range * cos_half_) continue;
      visit(InView{i, dx, dy, range, pose.heading});
    }
  }

 private:
  /// Returns the cosine of half the angle: exactly 0 for an angle of pi, and below -1, which
  /// excludes nothing, for a full circle.
  static double cosine_of_half(double angle) {
    if (angle == kPi) return 0.0;
    return angle >= kTwoPi ? -2.0 : std::cos(angle / 2.0);
  }

  double max_range_;
  double cos_half_;
  Mounting mounting_;
  double min_range_;
};

}  // namespace montecarta::models
