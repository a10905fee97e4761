// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/random/stream.hpp"
#include "filters/models/sensor.hpp"
#include "filters/models/vehicle.hpp"
#include "filters/models/vehicle_settings.hpp"

#include <array>
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

/// A vehicle for tests, with controls and noise that it may have.
struct SomeVehicle {
  std::string name;
  Vehicle vehicle;
  Control typical;  ///< a wide bend
  Control on_spot;  ///< turns where it stands, as far as it can
  std::array<double, 3> deviations;

  std::size_t controls() const { return controls_of(vehicle).size(); }
  /// Components that differ from the typical ones by a few deviations times `wide`.
  Control any_control(RngStream& draw, double wide) const {
    Control control = typical;
    for (std::size_t i = 0; i < controls(); ++i) control[i] += wide * deviations[i] * draw.normal();
    return control;
  }
};

/// So that a test is listed by the vehicle's name.
inline void PrintTo(const SomeVehicle& vehicle, std::ostream* out) { *out << vehicle.name; }

/// One of every kind, in all that it may choose.
inline std::vector<SomeVehicle> some_vehicles() {
  const Car car{.kind = Car::Kind::rear_wheel,
                .wheelbase = 2.83,
                .wheel_left = 0.76,
                .sensor_ahead = 3.78,
                .sensor_left = 0.5};
  const auto euler = Integration::euler;
  return {
      {"front_axle", Car{}, {3.0, 0.15}, {0.5, 0.5}, {0.3, 0.05}},
      {"rear_wheel", car, {3.0, 0.1}, {0.5, 0.5}, {0.3, 0.05}},
      {"differential_drive", DifferentialDrive{}, {3.0, 0.11}, {0.0, 1.0}, {0.3, 0.05}},
      {"differential_euler", DifferentialDrive{euler}, {3.0, 0.11}, {0.0, 1.0}, {0.3, 0.05}},
      {"omnidirectional", Omnidirectional{}, {2.5, 1.5, 0.1}, {0.0, 0.0, 1.0}, {0.3, 0.2, 0.05}},
      {"omnidirectional_euler",
       Omnidirectional{euler},
       {2.5, 1.5, 0.1},
       {0.0, 0.0, 1.0},
       {0.3, 0.2, 0.05}}};
}

/// Noise of the step by every model, as a robot has.
inline std::vector<IncrementNoise> some_increments() {
  return {{.model = IncrementModel::additive, .sigma = {0.05, 0.03, 0.02}},
          {.model = IncrementModel::odometry, .alpha = {0.05, 0.01, 0.02, 0.03}}};
}

}  // namespace montecarta::models
