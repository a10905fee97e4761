// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/numbers/real.hpp"

#include <array>
#include <cstddef>

/// What the files of vehicles share (EQUATIONS 1). A vehicle is a struct that says how a control
/// moves it; vehicle.hpp lists them and says what a vehicle must offer.
namespace montecarta::models {

/// A step as the vehicle sees it from where it was; where that is in the world does not matter.
template <class Real>
struct BodyStep {
  Real forward;  ///< [m]
  Real left;     ///< [m]
  Real turn;     ///< [rad] counter-clockwise
};

/// The angle in which a step is not linear, and its unit vector: the steering angle of a car, the
/// turn in this step of a vehicle whose yaw rate is controlled.
template <class Real>
struct Bend {
  Real angle;  ///< [rad]
  Direction<Real> direction;
};

/// The bend of that angle [rad].
template <class Real>
Bend<Real> bend_of(const Real& angle) {
  return {angle, direction_of(angle)};
}

/// What steers a simulated vehicle to a way-point.
struct Aim {
  Control before;       ///< of the step before; zero before the first
  double off;           ///< [rad] direction of the way-point less the heading, not wrapped
  double speed;         ///< [m/s] wanted
  double control_rate;  ///< [Hz]
};

/// One component of a control, as messages, logs and study files name it. Keys that end in _deg are
/// in degrees, everything else in SI units.
struct ControlName {
  const char* name;        ///< "speed": in messages
  const char* noun;        ///< "speed": in errors
  const char* column;      ///< "speed_mps": in odometry.csv
  double most;             ///< greatest size that a log may hold
  const char* limit;       ///< "metres per second, at most 1000": why a log with more is refused
  bool moves;              ///< whether the vehicle moves where this one alone is not 0
  const char* sigma;       ///< "sigma_speed": key of its noise
  const char* unit;        ///< of that key
  const char* usual;       ///< value of that key where nothing is said
  double most_sigma;       ///< greatest value of that key
  const char* noise_text;  ///< what that key means
};

/// Where a number of a vehicle is asked for.
enum class VehicleUse {
  motion,  ///< wherever the vehicle moves: in [scenario] and in [belief]
  pilot    ///< where a simulated vehicle is steered: in [scenario] alone
};

/// A number of a vehicle of type V, as study files name it; keys in _deg as above.
template <class V>
struct VehicleNumber {
  const char* key;
  const char* unit;
  const char* usual;  ///< value where nothing is said
  double least, most;
  const char* meaning;
  double V::*member;
  VehicleUse use = VehicleUse::motion;
  const char* example = "";  ///< not empty: for a log of the user's own it must be given
};

/// The speed of most vehicles.
inline constexpr ControlName kSpeedControl = {.name = "speed",
                                              .noun = "speed",
                                              .column = "speed_mps",
                                              .most = 1e3,
                                              .limit = "metres per second, at most 1000",
                                              .moves = true,
                                              .sigma = "sigma_speed",
                                              .unit = "m/s",
                                              .usual = "0.3",
                                              .most_sigma = 1000,
                                              .noise_text = "noise of the speed"};

}  // namespace montecarta::models
