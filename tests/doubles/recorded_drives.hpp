// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/random/stream.hpp"

#include <cmath>
#include <cstdint>

namespace montecarta::engine {

/// A drive as if it were recorded: nobody knows the truth, two references measured it, beacons are
/// surveyed and detections have no identity. The vehicle goes through an eight; the same for all
/// runs. "gps" is good to 5 cm but for one fix that is 136 m off, and measures headings; "coarse"
/// is good to 0.5 m, begins before the drive and ends after it.
class RecordedDrives : public DriveSource {
 public:
  static constexpr double kStep = 0.05;    ///< [s]
  static constexpr double kWildFix = 136;  ///< [m]

  explicit RecordedDrives(std::size_t steps) : duration_(kStep * static_cast<double>(steps)) {
    for (std::size_t k = 0; k < steps; ++k) {
      itinerary_.step_time.push_back(kStep * static_cast<double>(k + 1));
      if (k % 4 == 3) itinerary_.scan_step.push_back(static_cast<std::uint32_t>(k));
    }
    itinerary_.has_truth = false;
    itinerary_.start = pose_at(0.0);
    itinerary_.landmarks = {{20.0, 5.0}, {-20.0, 5.0}, {50.0, 40.0}, {-50.0, -40.0}};
    itinerary_.references = {measured("gps", 0.0, duration_, 0.05, 1),
                             measured("coarse", -2.0, duration_ + 2.0, 0.5, 2)};
    itinerary_.references[1].heading.clear();
    auto& fixes = itinerary_.references[0].position;
    fixes[fixes.size() / 2].y() += kWildFix;
  }

  /// The true pose of the vehicle at `time` [s].
  Pose pose_at(double time) const {
    const double turn = kTwoPi * time / duration_;
    const double dx = 60.0 * std::cos(turn), dy = 80.0 * std::cos(2.0 * turn);
    return {60.0 * std::sin(turn), 40.0 * std::sin(2.0 * turn), std::atan2(dy, dx)};
  }

  const Itinerary& itinerary() const override { return itinerary_; }

  void generate(std::uint64_t /*run*/, Drive& drive) const override {
    drive.controls.assign(itinerary_.steps(), {1.0, 0.0});
    drive.truth.clear();
    drive.detections.clear();
    drive.scan_begin.assign(1, 0);
    for (std::size_t s = 0; s < itinerary_.scans(); ++s) {
      drive.detections.push_back({5.0, 0.1, Detection::kUnidentified});
      drive.scan_begin.push_back(static_cast<std::uint32_t>(drive.detections.size()));
    }
  }

 private:
  /// Fixes every 0.2 s, between the rows.
  ReferencePath measured(const char* name, double from, double to, double sigma,
                         std::uint32_t which) const {
    ReferencePath path{name, {}, {}, {}};
    RngStream draw({5, 0, which, 0, Draw::test});
    for (double time = from + 0.03; time < to; time += 0.2) {
      const Pose pose = pose_at(time);
      path.time.push_back(time);
      path.position.emplace_back(pose.x + sigma * draw.normal(), pose.y + sigma * draw.normal());
      path.heading.push_back(wrap(pose.heading + 0.01 * draw.normal()));
    }
    return path;
  }

  double duration_;  ///< [s]
  Itinerary itinerary_;
};

}  // namespace montecarta::engine
