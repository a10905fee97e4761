// SPDX-License-Identifier: BSD-3-Clause
#include "filters/models/mounting.hpp"

#include "engine/numbers/angle.hpp"

namespace montecarta::models {

Pose Mounting::pose_of(const Pose& pose) const {
  if (is_none()) return pose;
  const Eigen::Vector2d arm = arm_of(pose);
  return {pose.x + arm.x(), pose.y + arm.y(), wrap(pose.heading + turn)};
}

Eigen::Matrix3d Mounting::jacobian(const Pose& pose) const {
  const Eigen::Vector2d arm = arm_of(pose);
  Eigen::Matrix3d M = Eigen::Matrix3d::Identity();
  M(0, 2) = -arm.y();
  M(1, 2) = arm.x();
  return M;
}

Eigen::Vector2d Mounting::arm_of(const Pose& pose) const {
  const Direction<double> heading = direction_of(pose.heading);
  return {heading.cosine * forward - heading.sine * left,
          heading.sine * forward + heading.cosine * left};
}

}  // namespace montecarta::models
