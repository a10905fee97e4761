// SPDX-License-Identifier: BSD-3-Clause
#include "filters/models/eigen_jacobians.hpp"

namespace montecarta::models {

Eigen::Matrix3d pose_jacobian(const MotionJacobians<double>& j) {
  Eigen::Matrix3d F;
  F << 1.0, 0.0, j.x_heading, 0.0, 1.0, j.y_heading, 0.0, 0.0, 1.0;
  return F;
}

ControlJacobian control_jacobian(const MotionJacobians<double>& j) {
  ControlJacobian F(3, j.controls);
  for (std::size_t i = 0; i < j.controls; ++i) {
    const auto& [x, y, heading] = j.by_control[i];
    F.col(static_cast<Eigen::Index>(i)) << x, y, heading;
  }
  return F;
}

Matrix23 pose_jacobian(const LinearisedObservation<double>& s) {
  Matrix23 H;
  H << -s.range_x, -s.range_y, 0.0, -s.bearing_x, -s.bearing_y, -1.0;
  return H;
}

Eigen::Matrix2d landmark_jacobian(const LinearisedObservation<double>& s) {
  Eigen::Matrix2d H;
  H << s.range_x, s.range_y, s.bearing_x, s.bearing_y;
  return H;
}

Matrix23 pose_jacobian(const LinearisedPlace<double>& p) {
  Matrix23 G;
  G << 1.0, 0.0, p.x_bearing, 0.0, 1.0, p.y_bearing;
  return G;
}

Eigen::Matrix2d observation_jacobian(const LinearisedPlace<double>& p) {
  Eigen::Matrix2d G;
  G << p.x_range, p.x_bearing, p.y_range, p.y_bearing;
  return G;
}

}  // namespace montecarta::models
