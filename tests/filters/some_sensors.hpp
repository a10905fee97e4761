// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/sensor.hpp"

#include <ostream>
#include <string>
#include <vector>

namespace montecarta::models {

/// A sensor for tests.
struct SomeSensor {
  std::string name;
  Sensor sensor;
};

/// So that a test is listed by the sensor's name.
inline void PrintTo(const SomeSensor& some, std::ostream* out) { *out << some.name; }

/// One of every kind, at the pose and mounted elsewhere.
inline std::vector<SomeSensor> some_sensors() {
  std::vector<SomeSensor> some;
  for_each_sensor([&](const Sensor& sensor) {
    const Mounting mounting{.forward = 0.8, .left = -0.3, .turn = 0.4};
    some.push_back({name_of(sensor), sensor});
    some.push_back({name_of(sensor) + "_mounted", {sensor.kind, mounting}});
  });
  return some;
}

}  // namespace montecarta::models
