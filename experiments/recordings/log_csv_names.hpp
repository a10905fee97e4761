// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <string>

namespace montecarta::experiments::log_csv {

/// Headers of each file of a log: without and with its optional last column.
using Headers = std::array<std::string, 2>;

inline const std::array<std::string, 1> kStart = {"time_s,x_m,y_m,heading_rad"};
inline const std::array<std::string, 1> kOdometry = {"time_s,speed_mps,steer_rad"};
inline const Headers kDetections = {"time_s,range_m,bearing_rad",
                                    "time_s,range_m,bearing_rad,identity"};
inline const Headers kReference = {"time_s,x_m,y_m", "time_s,x_m,y_m,heading_rad"};
inline const Headers kLandmarks = {"x_m,y_m", "x_m,y_m,identity"};

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
