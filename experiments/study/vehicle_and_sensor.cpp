// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/vehicle_and_sensor.hpp"

#include "engine/errors.hpp"

#include <optional>

namespace montecarta::experiments {
namespace {

/// The value of a setting; nullopt if the section has none, such as the limits of the pilot.
std::optional<double> number_of(const Settings& s, const char* in, const std::string& key) {
  return s.has(in, key) ? std::optional(s.number(in, key)) : std::nullopt;
}

}  // namespace

Vehicle vehicle_of(const Settings& s, const char* in) {
  const auto vehicle = vehicle_named(
      s.text(in, "vehicle"), [&](const auto& key) { return std::optional(s.text(in, key)); },
      [&](const auto& key) { return number_of(s, in, key); });
  expect(vehicle.has_value(), "a study has a vehicle that is not known");
  return *vehicle;
}

Sensor sensor_of(const Settings& s, const char* in) {
  const auto sensor =
      sensor_named(s.text(in, "sensor"), {.forward = s.number(in, "mount_forward"),
                                          .left = s.number(in, "mount_left"),
                                          .turn = wrap(s.radians(in, "mount_turn_deg"))});
  expect(sensor.has_value(), "a study has a sensor that is not known");
  return *sensor;
}

ControlNoise control_noise_of(const Settings& s, const char* in) {
  const auto noise =
      control_noise_of(vehicle_of(s, in), [&](const auto& key) { return number_of(s, in, key); });
  expect(noise.has_value(), "a study lacks the noise of a control");
  return *noise;
}

}  // namespace montecarta::experiments
