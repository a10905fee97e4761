// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "filters/models/sensor.hpp"
#include "filters/models/vehicle.hpp"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace montecarta::experiments {

/// A measured or commanded control, which holds from its time until the next one.
struct Odometry {
  double time = 0.0;  ///< [s] time from which the control holds
  Control control;
};

/// All detections at one instant.
struct LoggedScan {
  double time = 0.0;                  ///< [s] time of all detections of the scan
  std::vector<Detection> detections;  ///< detections in the sensor's order; may be empty
};

/// A recorded drive as it was measured, independent of its files. All times of a log have the same
/// origin.
struct DriveLog {
  /// [s] time at which the vehicle was at `start`. Its motion before is unknown.
  double start_time = 0.0;
  Pose start;
  std::span<const Quantity> controls = controls_of(Vehicle());     ///< components of the controls
  std::vector<Odometry> odometry;                                  ///< controls in increasing time
  std::span<const Quantity> components = components_of(Sensor());  ///< components of the detections
  std::vector<LoggedScan> scans;                                   ///< scans in increasing time
  std::vector<ReferencePath> references;   ///< one or more; the first is the leading one
  std::vector<Eigen::Vector2d> landmarks;  ///< [m] surveyed positions; empty if unknown
};

}  // namespace montecarta::experiments
