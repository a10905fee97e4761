// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/recordings/drive_log.hpp"
#include "experiments/text/words.hpp"

#include <filesystem>
#include <fstream>
#include <string>

// Small drives of our own making.
namespace montecarta::experiments {

inline void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// A log that uses everything a log can hold, with numbers that do not end in decimals.
inline DriveLog full_log() {
  DriveLog log;
  log.start_time = 1.0 / 11;
  log.start = {.x = 1.0 / 3, .y = -0.0, .heading = -2.0 / 3};
  log.odometry = {{0.1, {1.0 / 7, -1e-17}}, {0.30000000000000004, {-0.5, 1.0 / 9}}};
  log.scans = {{0.1, {}},
               {0.2, {{10.0 / 3, -1.0 / 3, 1}, {20.1, 0.7, Detection::kClutter}}},
               {0.3, {{5e-324, 0.0, 0}}}};
  log.references = {{"reference", {0.0, 1.0}, {{0, 0}, {1.0 / 3, 2}}, {0.1, 1.0 / 7}},
                    {"gps", {0.5}, {{1e5, -1e-5}}, {}}};
  log.references[0].covariance = {Eigen::Vector3d(1.0 / 3, 0.1, 1.0 / 7).asDiagonal(),
                                  Eigen::Matrix3d{{2, 0.1, -0.2}, {0.1, 1, 0}, {-0.2, 0, 1.0 / 9}}};
  log.landmarks = {{1.0 / 3, 2}, {-3, 4.0 / 7}};
  return log;
}

}  // namespace montecarta::experiments
