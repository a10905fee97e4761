// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/vehicle.hpp"

namespace montecarta::models {

/// The control that takes a vehicle through `step` in `duration` [s]: body_step() turned round, or
/// what comes nearest where the vehicle cannot move like that.
inline Control control_of(const BodyStep<double>& step, double duration, const Vehicle& vehicle) {
  return std::visit([&](const auto& one) { return one.control_of(step, duration); }, vehicle);
}

}  // namespace montecarta::models
