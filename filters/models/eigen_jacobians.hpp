// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/ackermann.hpp"

#include <Eigen/Core>

namespace montecarta::models {

/// The derivatives of the models as matrices (EQUATIONS 1, 2), for code outside the particle loop.
using Matrix32 = Eigen::Matrix<double, 3, 2>;
using Matrix23 = Eigen::Matrix<double, 2, 3>;

/// Fx: derivative of the pose after a step by the pose before it.
Eigen::Matrix3d pose_jacobian(const MotionJacobians<double>& j);

/// Fu: derivative of the pose after a step by the controls, one column for each.
using ControlJacobian = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, Control::kMost>;
ControlJacobian control_jacobian(const MotionJacobians<double>& j);

/// Hx: derivative of (range, bearing) by the pose.
Matrix23 pose_jacobian(const LinearisedObservation<double>& s);

/// Hf: derivative of (range, bearing) by the landmark.
Eigen::Matrix2d landmark_jacobian(const LinearisedObservation<double>& s);

/// Gx: derivative of the landmark by the pose.
Matrix23 pose_jacobian(const LinearisedPlace<double>& p);

/// Gz: derivative of the landmark by (range, bearing).
Eigen::Matrix2d observation_jacobian(const LinearisedPlace<double>& p);

inline Eigen::Vector2d to_vector(const RangeBearing<double>& observation) {
  return {observation.range, observation.bearing};
}
inline Eigen::Vector2d to_vector(const Point& point) { return {point.x, point.y}; }

}  // namespace montecarta::models
