// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/random/stream.hpp"

#include <cstdint>

namespace montecarta::engine {

/// Drives that never leave a straight line: `steps` of 25 ms, a scan after every fourth, with as
/// many detections as the run number and the scan allow, so that drives of different runs differ in
/// length.
class ScriptedDrives : public DriveSource {
 public:
  explicit ScriptedDrives(std::size_t steps, std::uint64_t seed = 7) : seed_(seed) {
    for (std::size_t k = 0; k < steps; ++k) {
      itinerary_.step_time.push_back(0.025 * static_cast<double>(k + 1));
      if (k % 4 == 3) itinerary_.scan_step.push_back(static_cast<std::uint32_t>(k));
    }
    itinerary_.landmarks = {{1.0, 2.0}, {3.0, -1.0}, {5.0, 0.5}};
    itinerary_.waypoints = {{0.0, 0.0}, {10.0, 0.0}};
    itinerary_.start = {0.5, -0.5, 0.25};
  }

  const Itinerary& itinerary() const override { return itinerary_; }

  void generate(std::uint64_t run, Drive& drive) const override {
    drive.controls.resize(itinerary_.steps());
    drive.truth.resize(itinerary_.steps());
    for (std::size_t k = 0; k < itinerary_.steps(); ++k) {
      RngStream draw({seed_, run, static_cast<std::uint32_t>(k), 0, Draw::world_control});
      drive.controls[k] = {1.0 + 0.1 * draw.normal(), 0.05 * draw.normal()};
      drive.truth[k] = {0.5 + itinerary_.step_time[k], -0.5 + 0.001 * static_cast<double>(run),
                        0.25};
    }
    drive.detections.clear();
    drive.scan_begin.assign(1, 0);
    for (std::size_t s = 0; s < itinerary_.scans(); ++s) add_scan(run, s, drive);
  }

 private:
  static void add_scan(std::uint64_t run, std::size_t s, Drive& drive) {
    for (std::size_t l = 0; l < (run + s) % 4; ++l)
      drive.detections.push_back({1.0 + static_cast<double>(l), 0.1, static_cast<std::int32_t>(l)});
    drive.scan_begin.push_back(static_cast<std::uint32_t>(drive.detections.size()));
  }

  std::uint64_t seed_;
  Itinerary itinerary_;
};

}  // namespace montecarta::engine
