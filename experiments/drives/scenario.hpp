// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/pose.hpp"
#include "engine/numbers/angle.hpp"
#include "filters/models/sensor.hpp"
#include "filters/models/vehicle.hpp"

#include <cstdint>

namespace montecarta::experiments {

/// Where the noise of the control goes (EQUATIONS 1).
enum class NoiseMode {
  measured_control,  ///< the truth obeys the nominal control; the filter is given a noisy one
  matched,           ///< the truth obeys a noisy control; the filter is given the nominal one
};

/// What a simulated vehicle steers by, where noise moves the truth (EQUATIONS 1).
enum class Pilot {
  closed_loop,  ///< its true pose: controls tell of the truth
  open_loop     ///< nothing: the controls of the noise-free drive
};

/// Where landmarks stand.
enum class MapPlacement {
  fixed,  ///< where the world has them, in every run
  random  ///< every run displaces each of them, uniformly within Scenario::map_shift
};

/// How a simulated vehicle drives through a world and what it sees (study file: [scenario]).
struct Scenario {
  NoiseMode noise = NoiseMode::measured_control;
  Pilot pilot = Pilot::closed_loop;
  MapPlacement map = MapPlacement::fixed;
  double map_shift = 10.0;           ///< [m] greatest displacement of a landmark of a random map
  std::uint32_t loops = 1;           ///< times round the way-points
  std::uint32_t steps_per_scan = 8;  ///< control_rate / scan_rate
  double control_rate = 40.0;        ///< [Hz]
  Vehicle vehicle = {};
  double speed = 3.0;                                       ///< [m/s]
  ControlNoise control{.sigma = {0.3, 3.0 * kPi / 180.0}};  ///< e.g. [m/s], [rad]
  double sigma_range = 0.1;                                 ///< [m]
  double sigma_bearing = 1.0 * kPi / 180.0;                 ///< [rad]
  double max_range = 30.0;                                  ///< [m]
  double field_of_view = kPi;     ///< [rad] full angle, centred where the sensor looks
  double waypoint_radius = 1.0;   ///< [m] nearer than this a way-point is reached
  double clutter_rate = 0.0;      ///< mean false alarms a scan
  double miss_probability = 0.0;  ///< that a visible landmark is not detected
  Pose start{};                   ///< before the first step
  Sensor sensor = {};             ///< whose components say which deviations count
  double sigma_forward = 0.1;     ///< [m] of a position in the frame of the sensor
  double sigma_left = 0.1;        ///< [m] likewise
  double min_range = 0.0;         ///< [m]
};

}  // namespace montecarta::experiments
