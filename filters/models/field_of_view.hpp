// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/pose.hpp"
#include "engine/numbers/angle.hpp"
#include "filters/models/sensor.hpp"

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <span>

namespace montecarta::models {

/// A landmark in view and where it stands from the sensor.
struct InView {
  std::size_t landmark = 0;  ///< index
  double dx = 0.0;           ///< [m] in the map's axes
  double dy = 0.0;           ///< [m]
  double range = 0.0;        ///< [m]
  double heading = 0.0;      ///< [rad] of the sensor
};

/// What a sensor can see: nearer than a range and ahead of it, both strictly, and not nearer than
/// another range (EQUATIONS 2).
class FieldOfView {
 public:
  /// `max_range` [m]; `angle` [rad] in full, centred where the sensor looks; `min_range` [m].
  FieldOfView(double max_range, double angle, const Mounting& mounting = {}, double min_range = 0.0)
      : max_range_(max_range),
        cos_half_(cosine_of_half(angle)),
        mounting_(mounting),
        min_range_(min_range) {}

  /// Calls visit(InView) for every landmark [m] in view from a vehicle at `vehicle`, in their
  /// order.
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
  /// Exactly 0 for half a turn, below -1 (never a limit) for a full one.
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
