// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/prior.hpp"
#include "engine/records/result_file.hpp"
#include "filters/models/field_of_view.hpp"
#include "filters/models/sensor.hpp"
#include "filters/models/vehicle.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <optional>

namespace montecarta::analysis {

/// The true vehicle, sensor and noise of a simulation, which filters may believe to be different.
struct SimulatedWorld {
  Vehicle vehicle;
  ControlNoise control_noise;
  /// Standard deviations of the sensor's components (deviations_of()).
  Eigen::Vector2d sigma_observation;
  double detected = 1.0;  ///< probability that a landmark in view is detected
  FieldOfView view;
  /// Whether all runs share the path: the noise is on the controls that filters receive.
  bool same_path = true;
  Sensor sensor = {};
  /// [m] Deviation of a fix of the position, and the number of scans from one to the next; 0 if
  /// there are none.
  double sigma_fix = 1.0;
  std::size_t scans_per_fix = 0;
  /// Deviations of what filters know at the start; nullopt if they estimate the map and know the
  /// start exactly.
  std::optional<PriorDeviations> prior = {};
};

/// Returns whether the filters of a study are given the map.
bool map_is_known(const ResultFile& file);

/// What filters of the file assume of their start and of a known map; exact if no map is known.
PriorDeviations believed_prior_of(const ResultFile& file);

/// The simulated world, read from the attributes of /scenario; nullopt if the file is not of a
/// simulation or lacks an attribute.
std::optional<SimulatedWorld> simulated_world_of(const ResultFile& file);

}  // namespace montecarta::analysis
