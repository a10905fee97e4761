// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "experiments/recordings/drive_log.hpp"

#include <filesystem>
#include <string>

namespace montecarta::experiments {

/// Reads a drive from a folder of comma-separated files, described in
/// experiments/RECORDED_DRIVES.md: start.csv, odometry.csv, detections.csv, reference.csv or
/// reference_NAME.csv, landmarks.csv. Throws StudyError naming file and line or record where one is
/// missing or malformed.
DriveLog read_log_csv(const std::filesystem::path& folder);

/// Writes `log` to a folder that is new or empty, so that reading it gives the same log bit for
/// bit. Throws StudyError where the folder holds something already or the log cannot be written so
/// (references out of the order in which they are read), RunError where writing fails.
void write_log_csv(const DriveLog& log, const std::filesystem::path& folder);

/// Likewise, with what an estimator must not see, references and landmarks, in a folder apart,
/// which is new or empty too.
void write_log_csv(const DriveLog& log, const std::filesystem::path& folder,
                   const std::filesystem::path& truth_folder);

/// Reads a reference of a log (experiments/RECORDED_DRIVES.md): fixes of a position or a pose, with
/// or without standard deviations or the covariance of their errors. Throws StudyError naming file
/// and line where a row is malformed, a standard deviation is not above 0, or a covariance is not
/// positive definite.
ReferencePath read_reference_csv(const std::filesystem::path& path, const std::string& name);

/// The text of that file; reading it gives the same numbers bit for bit.
std::string csv_of(const ReferencePath& reference);

}  // namespace montecarta::experiments
