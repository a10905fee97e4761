// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/range_bearing.hpp"
#include "filters/models/vehicle.hpp"

namespace montecarta::models {

/// Derivatives of one step (EQUATIONS 1), without the elements that are 0 or 1. Fx = [1 0
/// x_heading; 0 1 y_heading; 0 0 1]; the columns of Fu are in by_control.
template <class Real>
struct MotionJacobians {
  /// Derivatives of the pose by one component of the control, per its unit.
  struct MatrixColumn {
    Real x;        ///< [m]
    Real y;        ///< [m]
    Real heading;  ///< [rad]
  };
  Real x_heading;  ///< [m/rad]
  Real y_heading;  ///< [m/rad]
  std::array<MatrixColumn, Control::kMost>
      by_control;        ///< the first `controls` columns; others are 0
  std::size_t controls;  ///< number of controls of the vehicle
};

/// The pose after one step, and its derivatives by the pose before it and by the control.
template <class Real>
struct LinearisedMove {
  BasicPose<Real> pose;
  MotionJacobians<Real> jacobians;
};

/// Turns a displacement (forward, left) [m] of a vehicle with direction `heading` into the world.
template <class Real>
BasicPoint<Real> in_world(const Direction<Real>& heading, const Real& forward, const Real& left) {
  return {heading.cosine * forward - heading.sine * left,
          heading.sine * forward + heading.cosine * left};
}

/// A pose moved by a step, which is the same for all lanes (double) or differs between them (Real).
template <class Real, class Input>
BasicPose<Real> moved_by(const BasicPose<Real>& pose, const BodyStep<Input>& step) {
  const BasicPoint<Real> way =
      in_world(direction_of(pose.heading), Real(step.forward), Real(step.left));
  return {pose.x + way.x, pose.y + way.y, wrap(Real(pose.heading + Real(step.turn)))};
}

/// One step of a vehicle (EQUATIONS 1; Ankishan eq. (38) prints cos in both rows); `duration` [s].
template <class Real>
BasicPose<Real> move(const BasicPose<Real>& pose, const Control& control, double duration,
                     const Vehicle& vehicle) {
  return moved_by(pose, body_step(vehicle, control, duration));
}

/// move() with its derivatives at (pose, control). `heading` is the direction of the pose, and
/// `turning_angle` belongs to the control, which is the same for all lanes.
template <class Real, class V>
[[gnu::always_inline]] inline LinearisedMove<Real> linearised_move(
    const BasicPose<Real>& pose, const Direction<Real>& heading, const Control& control,
    const TurningAngle<double>& turning_angle, double duration, const V& vehicle) {
  const DifferentiatedStep<kControlsOf<V>> body =
      differentiated_step(vehicle, control, turning_angle, duration);
  const BasicPoint<Real> way = in_world(heading, Real(body.step.forward), Real(body.step.left));
  using MatrixColumn = typename MotionJacobians<Real>::MatrixColumn;
  // This is not a loop, since g++ 12 fuses the products of in_world() if it vectorises one.
  const auto column = [&](auto i) -> MatrixColumn {
    if constexpr (i < kControlsOf<V>) {
      const BodyStep<double>& by = body.by_control[i];
      const BasicPoint<Real> moved = in_world(heading, Real(by.forward), Real(by.left));
      return {moved.x, moved.y, Real(by.turn)};
    } else {
      return {};
    }
  };
  using First = std::integral_constant<std::size_t, 0>;
  using Second = std::integral_constant<std::size_t, 1>;
  using Third = std::integral_constant<std::size_t, 2>;
  return {{pose.x + way.x, pose.y + way.y, wrap(Real(pose.heading + Real(body.step.turn)))},
          {.x_heading = -way.y,
           .y_heading = way.x,
           .by_control = {column(First()), column(Second()), column(Third())},
           .controls = kControlsOf<V>}};
}

/// Does the same, and computes the direction of the pose and the turning angle of the control.
template <class Real>
LinearisedMove<Real> linearised_move(const BasicPose<Real>& pose, const Control& control,
                                     double duration, const Vehicle& vehicle) {
  return std::visit(
      [&](const auto& one) {
        return linearised_move(pose, direction_of(pose.heading), control,
                               turning_angle_of(bend_angle(one, control, duration)), duration, one);
      },
      vehicle);
}

/// `pose` in the frame of `origin`, the inverse of composed().
inline Pose relative_to(const Pose& origin, const Pose& pose) {
  const Direction<double> d = direction_of(origin.heading);
  const double dx = pose.x - origin.x, dy = pose.y - origin.y;
  return {d.cosine * dx + d.sine * dy, d.cosine * dy - d.sine * dx,
          wrap(pose.heading - origin.heading)};
}

/// The pose with the given `displacement` in the frame of `origin`.
inline Pose composed(const Pose& origin, const Pose& displacement) {
  const Point way = in_world(direction_of(origin.heading), displacement.x, displacement.y);
  return {origin.x + way.x, origin.y + way.y, wrap(origin.heading + displacement.heading)};
}

}  // namespace montecarta::models
