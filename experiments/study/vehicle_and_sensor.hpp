// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/study/settings.hpp"
#include "filters/models/sensor.hpp"
#include "filters/models/vehicle.hpp"
#include "filters/models/vehicle_settings.hpp"

#include <string>

namespace montecarta::experiments {

/// The vehicle of a section: [scenario] or [belief].
Vehicle vehicle_of(const Settings& settings, const char* section);
Sensor sensor_of(const Settings& settings, const char* section);
/// The noise of the controls of that vehicle, as set in the section.
ControlNoise control_noise_of(const Settings& settings, const char* section);
/// Sets the sensor of a belief or a scenario, its mounting and the deviations of its components
/// from a section. The deviations are multiplied by `factor`.
template <class Owner>
void take_sensor(const Settings& settings, const char* section, double factor, Owner& owner) {
  owner.sensor = sensor_of(settings, section);
  for (const Quantity quantity : components_of(owner.sensor)) {
    const std::string& key = component_of(quantity).sigma.key;
    deviation_of(quantity, owner) = factor * in_si(key, settings.number(section, key));
  }
}

}  // namespace montecarta::experiments
