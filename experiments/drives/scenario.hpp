// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/pose.hpp"
#include "engine/numbers/angle.hpp"
#include "filters/models/sensor.hpp"
#include "filters/models/vehicle.hpp"

#include <cstdint>

namespace montecarta::experiments {

/// Where the noise of the controls acts (EQUATIONS 1).
enum class NoiseMode {
  measured_control,  ///< the truth follows the nominal control; the filter is given a noisy one
  matched,           ///< the truth follows a noisy control; the filter is given the nominal one
};

/// How a simulated vehicle steers if noise acts on the truth (EQUATIONS 1).
enum class Pilot {
  closed_loop,  ///< by its true pose, so that controls depend on the truth
  open_loop     ///< by the controls of the noise-free drive
};

/// Positions of the landmarks.
enum class MapPlacement {
  fixed,  ///< as in the world, in every run
  random  ///< displaced in every run, uniformly within Scenario::map_shift
};

/// How a simulated vehicle drives through a world, and its sensor (study file: [scenario]).
struct Scenario {
  NoiseMode noise = NoiseMode::measured_control;
  Pilot pilot = Pilot::closed_loop;
  MapPlacement map = MapPlacement::fixed;
  double map_shift = 10.0;           ///< [m] largest displacement of a landmark of a random map
  std::uint32_t loops = 1;           ///< number of times round the way-points
  std::uint32_t steps_per_scan = 8;  ///< control_rate / scan_rate
  double control_rate = 40.0;        ///< [Hz]
  Vehicle vehicle = {};
  double speed = 3.0;                                       ///< [m/s]
  ControlNoise control{.sigma = {0.3, 3.0 * kPi / 180.0}};  ///< e.g. [m/s], [rad]
  double sigma_range = 0.1;                                 ///< [m]
  double sigma_bearing = 1.0 * kPi / 180.0;                 ///< [rad]
  double max_range = 30.0;                                  ///< [m]
  double field_of_view = kPi;     ///< [rad] full angle, centred on the axis of the sensor
  double waypoint_radius = 1.0;   ///< [m] distance within which a way-point is reached
  double clutter_rate = 0.0;      ///< mean number of false alarms per scan
  double miss_probability = 0.0;  ///< probability that a visible landmark is not detected
  Pose start{};                   ///< before the first step
  Sensor sensor = {};             ///< its components determine which deviations are used
  double sigma_forward = 0.1;     ///< [m] of a relative position, along the axis of the sensor
  double sigma_left = 0.1;        ///< [m] of a relative position, across that axis
  double min_range = 0.0;         ///< [m]
};

}  // namespace montecarta::experiments
