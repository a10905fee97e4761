// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/numbers/real.hpp"
#include "engine/runs/drive.hpp"
#include "engine/runs/pose.hpp"

namespace montecarta {

/// Derivatives of one Ackermann step (SPEC 2.1): only the elements that are not 0 or 1.
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

/// Vehicle steered at the front axle, which is also its reference point (SPEC 2.1; Ankishan eq.
/// (38) prints cos in both rows). `speed` [m/s] and `steer` [rad] are common to all lanes (double)
/// or one a lane (Real); `duration` [s]; `wheelbase` [m].
template <class Real, class Input>
BasicPose<Real> move(const BasicPose<Real>& pose, const Input& speed, const Input& steer,
                     double duration, double wheelbase) {
  using std::sin;
  const Real way = Real(speed * Input(duration));
  const Direction<Real> course = direction_of(Real(pose.heading + Real(steer)));
  const Input turn = speed * Input(duration / wheelbase) * sin(steer);
  return {pose.x + way * course.cosine, pose.y + way * course.sine,
          wrap(Real(pose.heading + Real(turn)))};
}

/// As above, with the control a filter is given.
template <class Real>
BasicPose<Real> move(const BasicPose<Real>& pose, const Control& control, double duration,
                     double wheelbase) {
  return move(pose, control.speed, control.steer, duration, wheelbase);
}

/// move() with its derivatives at (pose, control); the control is common to all lanes.
template <class Real>
LinearisedMove<Real> linearised_move(const BasicPose<Real>& pose, const Control& control,
                                     double duration, double wheelbase) {
  const double way = control.speed * duration;
  const Direction<Real> course = direction_of(Real(pose.heading + Real(control.steer)));
  const Direction<double> wheel = direction_of(control.steer);
  const Real along_x = Real(way) * course.cosine;
  const Real along_y = Real(way) * course.sine;
  const BasicPose<Real> moved{pose.x + along_x, pose.y + along_y,
                              wrap(Real(pose.heading + Real(way * wheel.sine / wheelbase)))};
  return {moved,
          {.x_heading = -along_y,
           .y_heading = along_x,
           .x_speed = Real(duration) * course.cosine,
           .x_steer = -along_y,
           .y_speed = Real(duration) * course.sine,
           .y_steer = along_x,
           .heading_speed = Real(duration * wheel.sine / wheelbase),
           .heading_steer = Real(way * wheel.cosine / wheelbase)}};
}

}  // namespace montecarta
