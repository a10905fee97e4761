// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "filters/models/sensor.hpp"
#include "filters/models/vehicle.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// What the vehicle measured of its motion, or was told; holds from its time to that of the next.
struct Odometry {
  double time = 0.0;  ///< [s]
  Control control;
};

/// All that the sensor saw at one instant.
struct LoggedScan {
  double time = 0.0;                  ///< [s]
  std::vector<Detection> detections;  ///< in the sensor's order; may be empty
};

/// A recorded drive as it was measured, whatever files it came in. Times of one log share an
/// origin.
struct DriveLog {
  /// [s] when the vehicle was at `start`; what it did before nobody knows.
  double start_time = 0.0;
  Pose start;
  std::span<const ControlName> controls = controls_of(Vehicle());  ///< what odometry consists of
  std::vector<Odometry> odometry;                                  ///< in increasing time
  std::span<const Quantity> components = components_of(Sensor());  ///< of the detections
  std::vector<LoggedScan> scans;                                   ///< in increasing time
  std::vector<ReferencePath> references;   ///< at least one; the first one leads
  std::vector<Eigen::Vector2d> landmarks;  ///< [m] surveyed positions; empty where unknown
};

}  // namespace montecarta::experiments
