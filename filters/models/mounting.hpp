// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/pose.hpp"
#include "engine/numbers/real.hpp"

#include <Eigen/Core>

namespace montecarta::models {

/// Where a sensor sits on the vehicle and where it looks (EQUATIONS 2).
struct Mounting {
  double forward = 0.0;  ///< [m] of the pose
  double left = 0.0;     ///< [m]
  double turn = 0.0;     ///< [rad] counter-clockwise from the heading

  bool is_none() const { return forward == 0.0 && left == 0.0 && turn == 0.0; }
  /// [m] from the pose.
  double distance() const { return length(forward, left); }

  /// Of the sensor, on a vehicle at `pose`.
  Pose pose_of(const Pose& pose) const;
  /// Derivative of pose_of() by the pose.
  Eigen::Matrix3d jacobian(const Pose& pose) const;

 private:
  Eigen::Vector2d arm_of(const Pose& pose) const;
};

}  // namespace montecarta::models
