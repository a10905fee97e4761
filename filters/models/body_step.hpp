// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/numbers/real.hpp"
#include "filters/models/parameter.hpp"

#include <algorithm>
#include <array>
#include <cmath>

/// The parts that all vehicles share (EQUATIONS 1). A vehicle is a struct that defines how a
/// control moves it; vehicle.hpp lists the vehicles and the members that a vehicle must have.
namespace montecarta::models {

/// Displacement of one step in the frame of the vehicle before the step.
template <class Real>
struct BodyStep {
  Real forward;  ///< [m]
  Real left;     ///< [m]
  Real turn;     ///< [rad] counter-clockwise
};

/// The angle in which a step is not linear, and its unit vector: the steering angle of a car, or
/// the turn during this step if the yaw rate is controlled.
template <class Real>
struct TurningAngle {
  Real angle;  ///< [rad]
  Direction<Real> direction;
};

template <class Real>
TurningAngle<Real> turning_angle_of(const Real& angle) {
  return {angle, direction_of(angle)};
}

/// The input of the pilot that steers a simulated vehicle to a way-point.
struct PilotInput {
  Control before;       ///< control of the previous step; zero at the first one
  double off;           ///< [rad] direction of the way-point minus the heading, not wrapped
  double speed;         ///< [m/s] desired speed
  double control_rate;  ///< [Hz] number of control steps per second
};

/// The place in which a number of a vehicle is set.
enum class VehicleUse {
  motion,  ///< it is part of the motion model: set in [scenario] and in [belief]
  pilot    ///< it limits the simulated pilot: set only in [scenario]
};

/// A number of a vehicle of type V. If `parameter` has an example, users must set it for their own
/// logs.
template <class V>
struct VehicleNumber {
  Parameter parameter;
  double V::*member;
  VehicleUse use = VehicleUse::motion;
};

// A body that moves with constant velocity in its own frame and turns at a constant yaw rate: the
// motion of all vehicles with a controlled yaw rate (EQUATIONS 1).

/// The integration of a motion of constant velocity and yaw rate over a step.
enum class Integration {
  arc,   ///< exactly: the velocity turns with the body
  euler  ///< the velocity keeps the direction from the beginning of the step
};
inline constexpr std::array<const char*, 2> kIntegrationNames = {"arc", "euler"};

/// Mean of the turning unit vector over the step, (sin t / t, (1 - cos t) / t) for the turn t; (1,
/// 0) for t = 0.
template <class Real>
struct MeanDirection {
  Real along, across;
};

/// Returns the mean direction of a step with this turn, which must be less than 1e5 rad.
template <class Real>
MeanDirection<Real> mean_direction(const TurningAngle<Real>& turn) {
  const auto& [cosine, sine] = turn.direction;
  const auto still = turn.angle == Real(0.0);
  const Real angle = select(still, Real(1.0), turn.angle);
  const Real along = select(still, Real(1.0), sine / angle);
  // 1 - cos t = sin^2 t / (1 + cos t), which has no cancellation for small t
  const auto ahead = cosine > Real(0.0);
  const Real small = along * sine / (Real(1.0) + select(ahead, cosine, Real(0.0)));
  return {along, select(ahead, small, (Real(1.0) - cosine) / angle)};
}

/// Derivative of mean_direction() by the turn [1/rad].
inline MeanDirection<double> mean_direction_by_turn(const TurningAngle<double>& turn) {
  const auto& [cosine, sine] = turn.direction;
  const double t = turn.angle;
  if (std::abs(t) < 1e-3) return {-t / 3.0 + t * t * t / 30.0, 0.5 - t * t / 8.0};
  const auto [along, across] = mean_direction(turn);
  return {(cosine - along) / t, (sine - across) / t};
}

/// Displacement by the velocity (forward, left) [m/s] in `duration` [s]; its turn is 0.
template <class Real>
BodyStep<Real> twist_travel(Integration integration, const Real& forward, const Real& left,
                            const TurningAngle<Real>& turn, double duration) {
  const Real ahead = forward * Real(duration), aside = left * Real(duration);
  if (integration == Integration::euler) return {ahead, aside, Real(0.0)};
  const auto [along, across] = mean_direction(turn);
  return {fma(ahead, along, -aside * across), fma(ahead, across, aside * along), Real(0.0)};
}

/// Derivative of twist_travel() by the turn, each element per rad.
inline BodyStep<double> twist_travel_by_turn(Integration integration, double forward, double left,
                                             const TurningAngle<double>& turn, double duration) {
  if (integration == Integration::euler) return {0.0, 0.0, 0.0};
  const double ahead = forward * duration, aside = left * duration;
  const auto [along, across] = mean_direction_by_turn(turn);
  return {fma(ahead, along, -aside * across), fma(ahead, across, aside * along), 0.0};
}

/// Inverse of twist_travel(): the velocity (forward, left) [m/s] and yaw rate [rad/s] of a step.
inline Control twist_of(Integration integration, const BodyStep<double>& step, double duration) {
  const double yaw_rate = step.turn / duration;
  const double ahead = step.forward / duration, aside = step.left / duration;
  if (integration == Integration::euler) return {ahead, aside, yaw_rate};
  const auto [along, across] = mean_direction(turning_angle_of(step.turn));
  const double square = along * along + across * across;  // 0 only after whole turns
  if (square == 0.0) return {0.0, 0.0, yaw_rate};
  return {fma(ahead, along, aside * across) / square, fma(aside, along, -ahead * across) / square,
          yaw_rate};
}

/// The yaw rate [rad/s] that turns by `off` [rad] in one control step, limited to `limit`.
inline double yaw_rate_towards(const PilotInput& input, double off, double limit) {
  return std::clamp(off * input.control_rate, -limit, limit);
}

/// The setting that limits the yaw rate of the pilot.
template <class V>
VehicleNumber<V> yaw_rate_limit_of(double V::*member) {
  return {number_parameter("yaw_rate_limit_deg", "90", 0.1, 5700, "fastest turn of the vehicle",
                           "deg/s"),
          member, VehicleUse::pilot};
}

}  // namespace montecarta::models
