// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/recordings/drive_log.hpp"

#include <bit>
#include <vector>

namespace montecarta::experiments {

/// Every number of a log by its bits, with the counts that tell where each part ends.
inline std::vector<std::uint64_t> bits_of(const DriveLog& log) {
  std::vector<std::uint64_t> bits;
  const auto add = [&bits](auto... numbers) {
    (bits.push_back(std::bit_cast<std::uint64_t>(static_cast<double>(numbers))), ...);
  };
  add(log.start.x, log.start.y, log.start.heading, log.odometry.size(), log.scans.size());
  for (const auto& [time, control] : log.odometry) add(time, control[0], control[1]);
  for (const auto& [time, detections] : log.scans) {
    add(time, detections.size());
    for (const auto& [values, identity] : detections) add(values[0], values[1], identity);
  }
  for (const auto& [name, times, positions, headings, covariances] : log.references) {
    add(times.size(), headings.size());
    for (const char c : name) add(c);
    for (const double time : times) add(time);
    for (const auto& position : positions) add(position.x(), position.y());
    for (const double heading : headings) add(heading);
    for (const auto& covariance : covariances) {
      for (const double element : covariance.reshaped()) add(element);
    }
  }
  for (const auto& landmark : log.landmarks) add(landmark.x(), landmark.y());
  return bits;
}

inline bool same_log(const DriveLog& a, const DriveLog& b) { return bits_of(a) == bits_of(b); }

}  // namespace montecarta::experiments
