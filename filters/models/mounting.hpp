// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/pose.hpp"
#include "engine/numbers/angle.hpp"
#include "engine/numbers/real.hpp"

#include <Eigen/Core>

#include <cmath>

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
  Pose pose_of(const Pose& pose) const {
    if (is_none()) return pose;
    const Eigen::Vector2d arm = arm_of(pose);
    return {pose.x + arm.x(), pose.y + arm.y(), wrap(pose.heading + turn)};
  }
  /// Derivative of pose_of() by the pose.
  Eigen::Matrix3d jacobian(const Pose& pose) const {
    const Eigen::Vector2d arm = arm_of(pose);
    Eigen::Matrix3d M = Eigen::Matrix3d::Identity();
    M(0, 2) = -arm.y();
    M(1, 2) = arm.x();
    return M;
  }

 private:
  Eigen::Vector2d arm_of(const Pose& pose) const {
    const Direction<double> heading = direction_of(pose.heading);
    return {heading.cosine * forward - heading.sine * left,
            heading.sine * forward + heading.cosine * left};
  }
};

}  // namespace montecarta::models
