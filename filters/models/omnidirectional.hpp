// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/body_step.hpp"

#include <string_view>

namespace montecarta::models {

/// A vehicle on Mecanum or Swedish wheels, which moves in any direction while it turns. The control
/// is (forward [m/s], left [m/s], yaw rate [rad/s]), and the pose is that of the point where these
/// are measured (EQUATIONS 1).
struct Omnidirectional {
  Integration integration = Integration::arc;
  double yaw_rate_limit = 90.0 * kPi / 180.0;  ///< [rad/s] largest yaw rate of the pilot

  static constexpr std::array<const char*, 1> kNames = {"omnidirectional"};
  const char* name() const { return kNames[0]; }
  static Omnidirectional named(std::string_view /*name*/) { return {}; }
  static constexpr std::array kControls = {Quantity::forward_speed, Quantity::left_speed,
                                           Quantity::yaw_rate};

  static constexpr bool kTurnsByAngle = true;
  static double angle_scale(double duration) { return duration; }

  template <class Real>
  BodyStep<Real> travel(const std::array<Real, 2>& velocity, const TurningAngle<Real>& turn,
                        double duration) const {
    return twist_travel(integration, velocity[0], velocity[1], turn, duration);
  }
  BodyStep<double> travel_by_angle(const std::array<double, 2>& velocity,
                                   const TurningAngle<double>& turn, double duration) const {
    return twist_travel_by_turn(integration, velocity[0], velocity[1], turn, duration);
  }
  Control control_of(const BodyStep<double>& step, double duration) const {
    return twist_of(integration, step, duration);
  }

  /// Drives straight to the way-point while it turns towards it.
  Control steered(const PilotInput& input) const {
    const double off = wrap(input.off);
    return {input.speed * std::cos(off), input.speed * std::sin(off),
            yaw_rate_towards(input, off, yaw_rate_limit)};
  }
  /// Distance [m] driven at `speed` [m/s] in the time of a full turn.
  double way_to_turn(double speed) const { return speed * kTwoPi / yaw_rate_limit; }
  static constexpr const char* kTurnLimit = "yaw_rate_limit_deg";

  static const std::array<VehicleNumber<Omnidirectional>, 1>& numbers() {
    static const std::array<VehicleNumber<Omnidirectional>, 1> all = {
        yaw_rate_limit_of(&Omnidirectional::yaw_rate_limit)};
    return all;
  }
};

}  // namespace montecarta::models
