// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/sensor.hpp"
#include "filters/models/vehicle.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <string>

namespace montecarta::experiments::log_csv {

/// Headers of each file of a log: without and with its optional last column.
using Headers = std::array<std::string, 2>;

inline const std::array<std::string, 1> kStart = {"time_s,x_m,y_m,heading_rad"};
/// Of the odometry of a vehicle with these controls.
inline std::string odometry_header(std::span<const Quantity> controls) {
  std::string header = "time_s";
  for (const Quantity control : controls) {
    header.append(",").append(component_of(control).column);
  }
  return header;
}
/// Of the detections of a sensor with these components.
inline Headers detection_headers(std::span<const Quantity> components) {
  std::string header = "time_s";
  for (const Quantity quantity : components)
    header.append(",").append(component_of(quantity).column);
  return {header, header + ",identity"};
}
inline const Headers kLandmarks = {"x_m,y_m", "x_m,y_m,identity"};

/// Headers of a reference: what a fix measures, then what is known of its error.
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

/// The reference of the file reference.csv; it comes first, others follow by name.
inline const std::string kLeading = "reference";

inline std::string file_of_reference(const std::string& name) {
  return name == kLeading ? "reference.csv" : "reference_" + name + ".csv";
}

/// Whether reference `a` is read before `b`.
inline bool is_before(const std::string& a, const std::string& b) {
  return a != b && (a == kLeading || (b != kLeading && a < b));
}

}  // namespace montecarta::experiments::log_csv
