// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/recordings/drive_log.hpp"

#include <span>
#include <string>

namespace montecarta::experiments {

/// An identity from here on is a mistake: no map has as many landmarks.
inline constexpr std::int32_t kMostIdentities = 1'000'000;

// Each throws StudyError "place: record N: problem (why): remedy" at the first record (from 1) that
// cannot be: time not increasing, a number not finite or beyond anything that drives, e.g. degrees
// in place of radians. `place` is the file.
void check_odometry(std::span<const Odometry> odometry, std::span<const ControlName> controls,
                    const std::string& place);
void check_scans(std::span<const LoggedScan> scans, const std::string& place,
                 std::span<const Quantity> components = components_of(Sensor()));
void check_reference(const ReferencePath& reference, const std::string& place);
void check_landmarks(std::span<const Eigen::Vector2d> landmarks, const std::string& place);

/// All of the above for the whole log, and what its parts owe to each other: odometry, scans and a
/// reference are there, references have different names, identities are given to all detections or
/// to none and belong to a landmark where landmarks are known. `place` is the folder.
void check_log(const DriveLog& log, const std::string& place);

}  // namespace montecarta::experiments
