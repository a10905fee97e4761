// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/numbers/real.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::models {

/// A car steered at the front: which of its points the pose is of, and what its controls mean.
struct Vehicle {
  enum class Kind {
    front_axle,  ///< pose and speed are of the middle of the front axle (EQUATIONS 1)
    rear_wheel   ///< pose is of the sensor, speed of a rear wheel (EQUATIONS 1)
  };
  Kind kind = Kind::front_axle;
  double wheelbase = 4.0;     ///< L [m]
  double wheel_left = 0.0;    ///< H [m] of the rear wheel, left of the middle of its axle
  double sensor_ahead = 0.0;  ///< a [m] of the sensor, from the middle of the rear axle
  double sensor_left = 0.0;   ///< b [m] likewise
};

/// The least share of the rear axle's speed that the measured wheel may have (EQUATIONS 1: a
/// guard). Nearer to the point about which the vehicle turns, that wheel says nothing of the
/// vehicle.
inline constexpr double kLeastWheelShare = 0.1;

/// Whether at this steering angle [rad] the measured wheel is that near.
inline bool turns_about_its_wheel(const Vehicle& vehicle, double steer) {
  return vehicle.kind == Vehicle::Kind::rear_wheel &&
         1.0 - vehicle.wheel_left / vehicle.wheelbase * std::tan(steer) < kLeastWheelShare;
}

/// A step as the vehicle sees it from where it was; where that is in the world does not matter.
template <class Real>
struct BodyStep {
  Real forward;  ///< [m]
  Real left;     ///< [m]
  Real turn;     ///< [rad] counter-clockwise
};

/// One control step: `speed` [m/s] and the direction of the steered wheel, of one vehicle (double)
/// or one a lane; `duration` [s]. Linear in the speed. EQUATIONS 1, in the frame of the
/// vehicle.
template <class Real>
BodyStep<Real> body_step(const Vehicle& vehicle, const Real& speed, const Direction<Real>& wheel,
                         double duration) {
  const Real way = speed * Real(duration);
  if (vehicle.kind == Vehicle::Kind::front_axle) {
    const Real left = way * wheel.sine;
    return {way * wheel.cosine, left, left * Real(1.0 / vehicle.wheelbase)};
  }
  const Real tangent = wheel.sine / wheel.cosine;
  const Real slower = max(Real(1.0) - Real(vehicle.wheel_left / vehicle.wheelbase) * tangent,
                          Real(kLeastWheelShare));
  const Real of_axle = way / slower;
  const Real turn = of_axle * tangent * Real(1.0 / vehicle.wheelbase);
  return {of_axle - Real(vehicle.sensor_left) * turn, Real(vehicle.sensor_ahead) * turn, turn};
}

/// The same, of a steering angle [rad].
template <class Real>
BodyStep<Real> body_step(const Vehicle& vehicle, const Real& speed, const Real& steer,
                         double duration) {
  return body_step(vehicle, speed, direction_of(steer), duration);
}

/// Derivative of body_step() by the steering angle, each element per rad.
inline BodyStep<double> steer_derivative(const Vehicle& vehicle, double speed,
                                         const Direction<double>& wheel, double duration) {
  const double way = speed * duration;
  const double L = vehicle.wheelbase;
  if (vehicle.kind == Vehicle::Kind::front_axle) {
    return {-way * wheel.sine, way * wheel.cosine, way * wheel.cosine / L};
  }
  const double tangent = wheel.sine / wheel.cosine;
  const double by_steer = 1.0 + tangent * tangent;  // of the tangent
  const double slower = std::max(1.0 - vehicle.wheel_left / L * tangent, kLeastWheelShare);
  const double of_axle = way * vehicle.wheel_left / L * by_steer / (slower * slower);
  const double turn = way * by_steer / (slower * slower * L);  // of v tan G, in one term
  return {of_axle - vehicle.sensor_left * turn, vehicle.sensor_ahead * turn, turn};
}

}  // namespace montecarta::models
