// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/ackermann.hpp"
#include "filters/models/range_bearing.hpp"

#include <Eigen/Core>

namespace montecarta::models {

/// The models' derivatives as the matrices of EQUATIONS 1 and 2, for code that is not per particle.
using Matrix32 = Eigen::Matrix<double, 3, 2>;
using Matrix23 = Eigen::Matrix<double, 2, 3>;

/// Fx: pose after by pose before.
inline Eigen::Matrix3d pose_jacobian(const MotionJacobians<double>& j) {
  Eigen::Matrix3d F;
  F << 1.0, 0.0, j.x_heading, 0.0, 1.0, j.y_heading, 0.0, 0.0, 1.0;
  return F;
}

/// Fu: pose after by the controls of the vehicle, of which each has a column.
using ControlJacobian = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, Control::kMost>;
inline ControlJacobian control_jacobian(const MotionJacobians<double>& j) {
  ControlJacobian F(3, j.controls);
  for (std::size_t i = 0; i < j.controls; ++i) {
    const auto& [x, y, heading] = j.by_control[i];
    F.col(static_cast<Eigen::Index>(i)) << x, y, heading;
  }
  return F;
}

/// Hx: (range, bearing) by pose.
inline Matrix23 pose_jacobian(const LinearisedObservation<double>& s) {
  Matrix23 H;
  H << -s.range_x, -s.range_y, 0.0, -s.bearing_x, -s.bearing_y, -1.0;
  return H;
}

/// Hf: (range, bearing) by landmark.
inline Eigen::Matrix2d landmark_jacobian(const LinearisedObservation<double>& s) {
  Eigen::Matrix2d H;
  H << s.range_x, s.range_y, s.bearing_x, s.bearing_y;
  return H;
}

/// Gx: landmark by pose.
inline Matrix23 pose_jacobian(const LinearisedPlace<double>& p) {
  Matrix23 G;
  G << 1.0, 0.0, p.x_bearing, 0.0, 1.0, p.y_bearing;
  return G;
}

/// Gz: landmark by (range, bearing).
inline Eigen::Matrix2d observation_jacobian(const LinearisedPlace<double>& p) {
  Eigen::Matrix2d G;
  G << p.x_range, p.x_bearing, p.y_range, p.y_bearing;
  return G;
}

inline Eigen::Vector2d to_vector(const RangeBearing<double>& observation) {
  return {observation.range, observation.bearing};
}
inline Eigen::Vector2d to_vector(const Point& point) { return {point.x, point.y}; }

}  // namespace montecarta::models
