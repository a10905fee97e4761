// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/pose.hpp"
#include "engine/numbers/angle.hpp"

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
};

/// What a sensor can see: nearer than a range and ahead, both strictly (EQUATIONS 2).
class FieldOfView {
 public:
  /// `max_range` [m]; `angle` [rad] in full, centred ahead.
  FieldOfView(double max_range, double angle)
      : max_range_(max_range), cos_half_(cosine_of_half(angle)) {}

  /// Calls visit(InView) for every landmark [m] in view from `pose`, in their order.
  template <class Visit>
  void look(const Pose& pose, std::span<const Eigen::Vector2d> landmarks,
            const Visit& visit) const {
    const double cosine = std::cos(pose.heading);
    const double sine = std::sin(pose.heading);
    for (std::size_t i = 0; i < landmarks.size(); ++i) {
      const double dx = landmarks[i].x() - pose.x;
      const double dy = landmarks[i].y() - pose.y;
      const double squared = dx * dx + dy * dy;
      if (squared >= max_range_ * max_range_) continue;
      const double range = std::sqrt(squared);
      if (dx * cosine + dy * sine <= range * cos_half_) continue;
      visit(InView{i, dx, dy, range});
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
};

}  // namespace montecarta::models
