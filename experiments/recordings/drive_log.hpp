// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "filters/models/sensor.hpp"
#include "filters/models/vehicle.hpp"

#include <Eigen/Core>

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
  std::span<const Quantity> controls = controls_of(Vehicle());     ///< what odometry consists of
  std::vector<Odometry> odometry;                                  ///< in increasing time
  std::span<const Quantity> components = components_of(Sensor());  ///< of the detections
  std::vector<LoggedScan> scans;                                   ///< in increasing time
  std::vector<ReferencePath> references;   ///< at least one; the first one leads
  std::vector<Eigen::Vector2d> landmarks;  ///< [m] surveyed positions; empty where unknown
};

/// An identity from here on is a mistake: no map has as many landmarks.
inline constexpr std::int32_t kMostIdentities = 1'000'000;

// Each throws StudyError "place: record N: problem (why): remedy" at the first record (from 1) that
// cannot be: time not increasing, a number not finite or beyond anything that drives, e.g. degrees
// in place of radians. `place` is the file.
void check_odometry(std::span<const Odometry> odometry, std::span<const Quantity> controls,
                    const std::string& place);
void check_scans(std::span<const LoggedScan> scans, const std::string& place,
                 std::span<const Quantity> components = components_of(Sensor()));
void check_reference(const ReferencePath& reference, const std::string& place);
void check_landmarks(std::span<const Eigen::Vector2d> landmarks, const std::string& place);

/// How a log is stored: as the files of kind = log, of which errors name one, or otherwise.
enum class LogForm { csv, other };

/// All of the above for the whole log, and what its parts owe to each other: odometry, scans and a
/// reference are there, references have different names, identities are given to all detections or
/// to none and belong to a landmark where landmarks are known. `place` is the folder.
void check_log(const DriveLog& log, const std::string& place, LogForm form = LogForm::other);

}  // namespace montecarta::experiments
