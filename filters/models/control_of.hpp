// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "filters/models/vehicle.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::models {

/// The control that takes a vehicle through `step` in `duration` [s]: body_step() turned round. A
/// vehicle that did not move has an unknown steering angle: 0.
inline Control control_of(const BodyStep<double>& step, double duration, const Vehicle& vehicle) {
  if (vehicle.kind == Vehicle::Kind::front_axle) {
    return {std::hypot(step.forward, step.left) / duration, std::atan2(step.left, step.forward)};
  }
  const double of_axle = step.forward + vehicle.sensor_left * step.turn;
  if (of_axle == 0.0) return {};
  const double tangent = step.turn * vehicle.wheelbase / of_axle;
  const double slower =
      std::max(1.0 - vehicle.wheel_left / vehicle.wheelbase * tangent, kLeastWheelShare);
  return {of_axle * slower / duration, std::atan(tangent)};
}

}  // namespace montecarta::models
