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
Eigen::Matrix3d pose_jacobian(const MotionJacobians<double>& j);

/// Fu: pose after by the controls of the vehicle, of which each has a column.
using ControlJacobian = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, Control::kMost>;
ControlJacobian control_jacobian(const MotionJacobians<double>& j);

/// Hx: (range, bearing) by pose.
Matrix23 pose_jacobian(const LinearisedObservation<double>& s);

/// Hf: (range, bearing) by landmark.
Eigen::Matrix2d landmark_jacobian(const LinearisedObservation<double>& s);

/// Gx: landmark by pose.
Matrix23 pose_jacobian(const LinearisedPlace<double>& p);

/// Gz: landmark by (range, bearing).
Eigen::Matrix2d observation_jacobian(const LinearisedPlace<double>& p);

inline Eigen::Vector2d to_vector(const RangeBearing<double>& observation) {
  return {observation.range, observation.bearing};
}
inline Eigen::Vector2d to_vector(const Point& point) { return {point.x, point.y}; }

}  // namespace montecarta::models
