// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "experiments/recordings/drive_log.hpp"
#include "filters/models/sensor.hpp"
#include "filters/models/vehicle.hpp"

#include <array>
#include <filesystem>
#include <span>
#include <string>

namespace montecarta::experiments::log_csv {

/// Headers of a file of a log, without and with its optional last column.
using Headers = std::array<std::string, 2>;

inline const std::array<std::string, 1> kStart = {"time_s,x_m,y_m,heading_rad"};
/// Header of the odometry of a vehicle with these controls.
inline std::string odometry_header(std::span<const Quantity> controls) {
  std::string header = "time_s";
  for (const Quantity control : controls) {
    header.append(",").append(component_of(control).column);
  }
  return header;
}
/// Headers of the detections of a sensor with these components.
inline Headers detection_headers(std::span<const Quantity> components) {
  std::string header = "time_s";
  for (const Quantity quantity : components)
    header.append(",").append(component_of(quantity).column);
  return {header, header + ",identity"};
}
inline const Headers kLandmarks = {"x_m,y_m", "x_m,y_m,identity"};

/// Headers of a reference: the components of a fix, then the form of its uncertainty.
enum class ReferenceColumns {
  position,
  pose,
  position_sigmas,
  pose_sigmas,
  position_covariance,
  pose_covariance
};
inline const std::array<std::string, 6> kReference = {
    "time_s,x_m,y_m",
    "time_s,x_m,y_m,heading_rad",
    "time_s,x_m,y_m,sigma_x_m,sigma_y_m",
    "time_s,x_m,y_m,heading_rad,sigma_x_m,sigma_y_m,sigma_heading_rad",
    "time_s,x_m,y_m,var_x_m2,cov_x_y_m2,var_y_m2",
    "time_s,x_m,y_m,heading_rad,var_x_m2,cov_x_y_m2,var_y_m2,"
    "cov_x_heading_m_rad,cov_y_heading_m_rad,var_heading_rad2"};

inline bool has_heading(ReferenceColumns columns) {
  return columns == ReferenceColumns::pose || columns == ReferenceColumns::pose_sigmas ||
         columns == ReferenceColumns::pose_covariance;
}

inline const std::string& header_of(ReferenceColumns columns) {
  return kReference[static_cast<std::size_t>(columns)];
}

/// Name of the reference in reference.csv. It comes first; the others follow in alphabetical order.
inline const std::string kLeading = "reference";

inline std::string file_of_reference(const std::string& name) {
  return name == kLeading ? "reference.csv" : "reference_" + name + ".csv";
}

/// Whether reference `a` is read before `b`.
inline bool is_before(const std::string& a, const std::string& b) {
  return a != b && (a == kLeading || (b != kLeading && a < b));
}

}  // namespace montecarta::experiments::log_csv

namespace montecarta::experiments {

/// Reads a drive from a folder of comma-separated files (experiments/RECORDED_DRIVES.md):
/// start.csv, odometry.csv, detections.csv, reference.csv or reference_NAME.csv, landmarks.csv.
/// Throws StudyError with file and line or record if a file is missing or malformed.
DriveLog read_log_csv(const std::filesystem::path& folder);

/// Writes `log` to a new or empty folder. Reading it gives the same log, bit for bit. Throws
/// StudyError if the folder is not empty or the references are not in the order in which they are
/// read, and RunError if writing fails.
void write_log_csv(const DriveLog& log, const std::filesystem::path& folder);

/// Like above, but writes references and landmarks, which an estimator must not see, to a separate
/// folder. It must be new or empty too.
void write_log_csv(const DriveLog& log, const std::filesystem::path& folder,
                   const std::filesystem::path& truth_folder);

/// Reads a reference of a log (experiments/RECORDED_DRIVES.md): fixes of a position or a pose,
/// optionally with standard deviations or the covariance of their errors. Throws StudyError with
/// file and line if a row is malformed, a standard deviation is not positive or a covariance is not
/// positive definite.
ReferencePath read_reference_csv(const std::filesystem::path& path, const std::string& name);

/// The text of such a file. Reading it gives the same numbers, bit for bit.
std::string csv_of(const ReferencePath& reference);

}  // namespace montecarta::experiments
