// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/recordings/drive_log.hpp"

#include <filesystem>
#include <span>
#include <string>

namespace montecarta::experiments {

/// Name of the reference in reference.csv. It comes first; the others follow in alphabetical order.
inline const std::string kLeadingReference = "reference";

/// Name of the file of a reference: "reference.csv" or "reference_NAME.csv".
inline std::string file_of_reference(const std::string& name) {
  return name == kLeadingReference ? "reference.csv" : "reference_" + name + ".csv";
}

/// Reads a drive from a folder of comma-separated files (experiments/RECORDED_DRIVES.md):
/// start.csv, odometry.csv, detections.csv, reference.csv or reference_NAME.csv, landmarks.csv.
/// Throws StudyError with file and line if a file is missing or malformed, or if a number is not
/// plausible for a vehicle, e.g. degrees instead of radians. Also checks that the parts fit
/// together: odometry, scans and a reference exist, references have different names, and identities
/// belong to a landmark if landmarks are known.
DriveLog read_log_csv(const std::filesystem::path& folder);

/// Writes `log` to a new or empty folder. Reading it gives the same log, bit for bit, if its
/// references are in the order in which they are read. Throws StudyError if the folder is not
/// empty, or if a control or a detection has a number that the reader refuses, and RunError if
/// writing fails.
void write_log_csv(const DriveLog& log, const std::filesystem::path& folder);

/// Writes a log like the function above, but references and landmarks, which an estimator must not
/// see, to a separate folder. That must be new or empty too.
void write_log_csv(const DriveLog& log, const std::filesystem::path& folder,
                   const std::filesystem::path& truth_folder);

/// Writes the landmarks.csv of a log: positions [m] by identity.
void write_landmarks_csv(std::span<const Eigen::Vector2d> landmarks,
                         const std::filesystem::path& folder);

/// Reads a reference of a log (experiments/RECORDED_DRIVES.md): fixes of a position or a pose,
/// optionally with standard deviations or the covariance of their errors. Throws StudyError with
/// file and line if a row is malformed, a standard deviation is not positive or a covariance is not
/// positive definite.
ReferencePath read_reference_csv(const std::filesystem::path& path, const std::string& name);

/// The text of a file of a reference. Reading it gives the same numbers, bit for bit.
std::string csv_of(const ReferencePath& reference);

}  // namespace montecarta::experiments
