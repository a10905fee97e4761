// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/body_step.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace montecarta::models {

/// Least ratio of the speed of the measured wheel to that of the middle of the rear axle, a guard
/// (EQUATIONS 1). Nearer to the centre of rotation, the speed of the wheel does not determine the
/// speed of the vehicle.
inline constexpr double kLeastWheelShare = 0.1;

/// A car that is steered at the front wheels. Its control is (speed [m/s], steering angle [rad]); a
/// step is linear in the speed and nonlinear in the steering angle. `Kind` defines the
/// reference point of the pose and of the speed.
struct Car {
  enum class Kind {
    front_axle,  ///< pose and speed of the middle of the front axle (EQUATIONS 1)
    rear_wheel   ///< pose of the sensor, speed of a rear wheel (EQUATIONS 1)
  };
  Kind kind = Kind::front_axle;
  double wheelbase = 4.0;                        ///< L [m]: distance between the axles
  double wheel_left = 0.0;                       ///< H [m]: rear wheel, left of the axle's middle
  double sensor_ahead = 0.0;                     ///< a [m]: the sensor, ahead of the rear axle
  double sensor_left = 0.0;                      ///< b [m]: the sensor, left of the middle
  double steer_limit = 30.0 * kPi / 180.0;       ///< [rad] largest steering angle of the pilot
  double steer_rate_limit = 20.0 * kPi / 180.0;  ///< [rad/s] largest steering rate of the pilot

  static constexpr std::array<const char*, 2> kNames = {"front_axle", "rear_wheel"};
  const char* name() const { return kNames[kind == Kind::front_axle ? 0 : 1]; }
  static Car named(std::string_view name) {
    return {.kind = name == kNames[0] ? Kind::front_axle : Kind::rear_wheel};
  }
  static constexpr std::array kControls = {Quantity::speed, Quantity::steer};

  static constexpr bool kTurnsByAngle = false;
  static double angle_scale(double /*duration*/) { return 1.0; }

  /// Displacement in the frame of the vehicle (EQUATIONS 1), linear in the speed.
  template <class Real>
  BodyStep<Real> travel(const std::array<Real, 1>& speed, const TurningAngle<Real>& steer,
                        double duration) const {
    const auto& wheel = steer.direction;
    const Real way = speed[0] * Real(duration);
    if (kind == Kind::front_axle) {
      const Real left = way * wheel.sine;
      return {way * wheel.cosine, left, left * Real(1.0 / wheelbase)};
    }
    const Real tangent = wheel.sine / wheel.cosine;
    const Real slower =
        max(Real(1.0) - Real(wheel_left / wheelbase) * tangent, Real(kLeastWheelShare));
    const Real of_axle = way / slower;
    const Real turn = of_axle * tangent * Real(1.0 / wheelbase);
    return {of_axle - Real(sensor_left) * turn, Real(sensor_ahead) * turn, turn};
  }

  /// Derivative of travel() by the steering angle, each element per rad.
  BodyStep<double> travel_by_angle(const std::array<double, 1>& speed,
                                   const TurningAngle<double>& steer, double duration) const {
    const auto& wheel = steer.direction;
    const double way = speed[0] * duration;
    const double L = wheelbase;
    if (kind == Kind::front_axle) {
      return {-way * wheel.sine, way * wheel.cosine, way * wheel.cosine / L};
    }
    const double tangent = wheel.sine / wheel.cosine;
    const double by_steer = 1.0 + tangent * tangent;  // derivative of the tangent
    const double slower = std::max(1.0 - wheel_left / L * tangent, kLeastWheelShare);
    const double of_axle = way * wheel_left / L * by_steer / (slower * slower);
    const double turn = way * by_steer / (slower * slower * L);  // derivative of v tan G
    return {of_axle - sensor_left * turn, sensor_ahead * turn, turn};
  }

  /// Inverse of travel(). If the car did not move, the steering angle is not known and taken as 0.
  Control control_of(const BodyStep<double>& step, double duration) const {
    if (kind == Kind::front_axle) {
      return {length(step.forward, step.left) / duration, std::atan2(step.left, step.forward)};
    }
    const double of_axle = step.forward + sensor_left * step.turn;
    if (of_axle == 0.0) return {};
    const double tangent = step.turn * wheelbase / of_axle;
    const double slower = std::max(1.0 - wheel_left / wheelbase * tangent, kLeastWheelShare);
    return {of_axle * slower / duration, std::atan(tangent)};
  }

  /// Turns the steering towards the way-point, limited in rate and angle (EQUATIONS (1.7)).
  Control steered(const PilotInput& input) const {
    const double steer = input.before[1];
    const double most = steer_rate_limit / input.control_rate;
    const double change = std::clamp(wrap(input.off - steer), -most, most);
    return {input.speed, std::clamp(steer + change, -steer_limit, steer_limit)};
  }
  /// Longest distance [m] needed to reach any heading: a full circle, and the way to full lock.
  double way_to_turn(double speed) const {
    const double turning_circle = kTwoPi * wheelbase / std::sin(steer_limit);
    return turning_circle + speed * (steer_limit / steer_rate_limit);
  }
  static constexpr const char* kTurnLimit = "steer_rate_limit_deg";

  /// Returns whether the control brings the measured wheel too near to the centre of rotation.
  bool is_beyond_model(const Control& control) const {
    return kind == Kind::rear_wheel &&
           1.0 - wheel_left / wheelbase * std::tan(control[1]) < kLeastWheelShare;
  }

  static const std::array<VehicleNumber<Car>, 6>& numbers() {
    constexpr auto pilot = VehicleUse::pilot;
    const auto wheelbase_parameter = [] {
      Parameter parameter =
          number_parameter("wheelbase", "4", 1e-3, 1000, "between the axles", "m");
      parameter.example = "2.83";
      return parameter;
    };
    const auto place = [](const char* key, const char* meaning) {
      return number_parameter(key, "0", -1000, 1000, meaning, "m");
    };
    static const std::array<VehicleNumber<Car>, 6> all = {
        {{wheelbase_parameter(), &Car::wheelbase},
         {place("wheel_left", "measured rear wheel left of the middle"), &Car::wheel_left},
         {place("sensor_ahead", "sensor ahead of the rear axle"), &Car::sensor_ahead},
         {place("sensor_left", "sensor left of the middle"), &Car::sensor_left},
         {number_parameter("steer_limit_deg", "30", 0.1, 89, "largest steering angle", "deg"),
          &Car::steer_limit, pilot},
         {number_parameter("steer_rate_limit_deg", "20", 0.1, 1e5, "fastest turn of the steering",
                           "deg/s"),
          &Car::steer_rate_limit, pilot}}};
    return all;
  }
};

}  // namespace montecarta::models
