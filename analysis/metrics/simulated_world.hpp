// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_file.hpp"
#include "filters/models/field_of_view.hpp"
#include "filters/models/sensor.hpp"
#include "filters/models/vehicle.hpp"

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace montecarta::analysis {

/// Vehicle, sensor and their noise as they really are in a simulation, whatever filters believe.
struct SimulatedWorld {
  Vehicle vehicle;
  ControlNoise control_noise;
  Eigen::Vector2d sigma_observation;  ///< of the sensor's components (deviations_of())
  double detected = 1.0;              ///< probability that what is in view is detected
  FieldOfView view;
  bool same_path = true;  ///< of all runs: the noise is on the controls that filters are given
  Sensor sensor = {};
};

/// What the file says of its world in the attributes of /scenario; nullopt where it is not that of
/// a simulation, or lacks any of it.
std::optional<SimulatedWorld> simulated_world_of(const ResultFile& file);

}  // namespace montecarta::analysis
