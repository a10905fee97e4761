// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/body_step.hpp"

#include <string_view>

namespace montecarta::models {

/// Two wheels on one axle, each with its own motor, so that it can turn on the spot. The control is
/// (speed [m/s], yaw rate [rad/s]), the pose that of the middle of the axle (EQUATIONS 1).
struct DifferentialDrive {
  Integration integration = Integration::arc;
  double yaw_rate_limit = 90.0 * kPi / 180.0;  ///< [rad/s] largest yaw rate of the pilot
  /// [rad] angle to the way-point beyond which the pilot turns on the spot.
  double turn_on_spot = 45.0 * kPi / 180.0;

  static constexpr std::array<const char*, 1> kNames = {"differential_drive"};
  const char* name() const { return kNames[0]; }
  static DifferentialDrive named(std::string_view /*name*/) { return {}; }
  static constexpr std::array kControls = {Quantity::speed, Quantity::yaw_rate};

  static constexpr bool kTurnsByAngle = true;
  static double angle_scale(double duration) { return duration; }

  template <class Real>
  BodyStep<Real> travel(const std::array<Real, 1>& speed, const TurningAngle<Real>& turn,
                        double duration) const {
    return twist_travel(integration, speed[0], Real(0.0), turn, duration);
  }
  BodyStep<double> travel_by_angle(const std::array<double, 1>& speed,
                                   const TurningAngle<double>& turn, double duration) const {
    return twist_travel_by_turn(integration, speed[0], 0.0, turn, duration);
  }
  /// The nearest possible control, since the vehicle cannot move sideways.
  Control control_of(const BodyStep<double>& step, double duration) const {
    const Control twist = twist_of(integration, step, duration);
    return {twist[0], twist[2]};
  }

  Control steered(const PilotInput& input) const {
    const double off = wrap(input.off);
    const double speed = std::abs(off) > turn_on_spot ? 0.0 : input.speed;
    return {speed, yaw_rate_towards(input, off, yaw_rate_limit)};
  }
  /// Distance [m] driven at `speed` [m/s] in the time of a full turn.
  double way_to_turn(double speed) const { return speed * kTwoPi / yaw_rate_limit; }
  static constexpr const char* kTurnLimit = "yaw_rate_limit_deg";

  static const std::array<VehicleNumber<DifferentialDrive>, 2>& numbers() {
    static const std::array<VehicleNumber<DifferentialDrive>, 2> all = {
        yaw_rate_limit_of(&DifferentialDrive::yaw_rate_limit),
        {number_parameter("turn_on_spot_deg", "45", 0.1, 180,
                          "farther off the way-point it stops and turns on the spot", "deg"),
         &DifferentialDrive::turn_on_spot, VehicleUse::pilot}};
    return all;
  }
};

}  // namespace montecarta::models
