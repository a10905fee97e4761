// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/core/pose.hpp"
#include "engine/numbers/real.hpp"
#include "filters/models/point.hpp"
#include "filters/models/vehicle.hpp"

namespace montecarta::models {

/// Derivatives of one step (EQUATIONS 1): only the elements that are not 0 or 1.
/// Fx = [1 0 x_heading; 0 1 y_heading; 0 0 1], Fu = [x_speed x_steer; y_speed y_steer;
/// heading_speed heading_steer].
template <class Real>
struct MotionJacobians {
  Real x_heading;      ///< [m/rad]
  Real y_heading;      ///< [m/rad]
  Real x_speed;        ///< [s]
  Real x_steer;        ///< [m/rad]
  Real y_speed;        ///< [s]
  Real y_steer;        ///< [m/rad]
  Real heading_speed;  ///< [rad s/m]
  Real heading_steer;  ///< [1]
};

/// Where one step leads and how it depends on where it began.
template <class Real>
struct LinearisedMove {
  BasicPose<Real> pose;
  MotionJacobians<Real> jacobians;
};

/// A displacement (forward, left) of a vehicle that heads along `heading`, in the world [m].
template <class Real>
BasicPoint<Real> in_world(const Direction<Real>& heading, const Real& forward, const Real& left) {
  return {heading.cosine * forward - heading.sine * left,
          heading.sine * forward + heading.cosine * left};
}

/// One step of a vehicle (EQUATIONS 1; Ankishan eq. (38) prints cos in both rows). `speed`
/// [m/s] and `steer` [rad] are common to all lanes (double) or one a lane (Real); `duration` [s].
template <class Real, class Input>
BasicPose<Real> move(const BasicPose<Real>& pose, const Input& speed, const Input& steer,
                     double duration, const Vehicle& vehicle) {
  const BodyStep<Input> step = body_step(vehicle, speed, steer, duration);
  const BasicPoint<Real> way =
      in_world(direction_of(pose.heading), Real(step.forward), Real(step.left));
  return {pose.x + way.x, pose.y + way.y, wrap(Real(pose.heading + Real(step.turn)))};
}

/// As above, with the control a filter is given.
template <class Real>
BasicPose<Real> move(const BasicPose<Real>& pose, const Control& control, double duration,
                     const Vehicle& vehicle) {
  return move(pose, control.speed, control.steer, duration, vehicle);
}

/// move() with its derivatives at (pose, speed, steer), where `heading` and `wheel` are the
/// directions of the pose and of the steering angle; the control is common to all lanes.
template <class Real>
LinearisedMove<Real> linearised_move(const BasicPose<Real>& pose, const Direction<Real>& heading,
                                     double speed, const Direction<double>& wheel, double duration,
                                     const Vehicle& vehicle) {
  const BodyStep<double> step = body_step(vehicle, speed, wheel, duration);
  const BodyStep<double> by_speed = body_step(vehicle, 1.0, wheel, duration);
  const BodyStep<double> by_steer = steer_derivative(vehicle, speed, wheel, duration);
  const BasicPoint<Real> way = in_world(heading, Real(step.forward), Real(step.left));
  const BasicPoint<Real> faster = in_world(heading, Real(by_speed.forward), Real(by_speed.left));
  const BasicPoint<Real> bent = in_world(heading, Real(by_steer.forward), Real(by_steer.left));
  const BasicPose<Real> moved{pose.x + way.x, pose.y + way.y,
                              wrap(Real(pose.heading + Real(step.turn)))};
  return {moved,
          {.x_heading = -way.y,
           .y_heading = way.x,
           .x_speed = faster.x,
           .x_steer = bent.x,
           .y_speed = faster.y,
           .y_steer = bent.y,
           .heading_speed = Real(by_speed.turn),
           .heading_steer = Real(by_steer.turn)}};
}

/// The same at (pose, control).
template <class Real>
LinearisedMove<Real> linearised_move(const BasicPose<Real>& pose, const Control& control,
                                     double duration, const Vehicle& vehicle) {
  return linearised_move(pose, direction_of(pose.heading), control.speed,
                         direction_of(control.steer), duration, vehicle);
}

}  // namespace montecarta::models
