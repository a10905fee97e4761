// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/recordings/drive_log.hpp"

namespace montecarta::experiments {

/// A recorded drive as the engine takes it: odometry, scans and fixes merged by their times, which
/// are counted from the start. A step ends wherever odometry or a scan comes in, so that no
/// step has two scans, and drives by the odometry that came in last. Before the first odometry the
/// vehicle stands. Scans that a delay puts before the start are taken there. All runs are the same:
/// they differ by the filter's random numbers alone.
class RecordedDrive final : public DriveSource {
 public:
  /// Distances [m] of detections that are used, as far as detections say how far they are.
  struct Reach {
    double max_range;
    double min_range = 0.0;
  };
  /// Scans happened `scan_delay` [s] before the log has them (a laser scanner takes its time to
  /// send). The log must have passed check_log().
  RecordedDrive(const DriveLog& log, const Reach& reach, double scan_delay = 0.0);

  const Itinerary& itinerary() const override { return itinerary_; }
  void generate(std::uint64_t run, Drive& drive) const override;

 private:
  void merge(const DriveLog& log, const Reach& reach, double scan_delay);
  void end_step(double time, const Control& control);
  void take_scan(const LoggedScan& scan, std::span<const Quantity> components, const Reach& reach);

  Itinerary itinerary_;
  Drive drive_;
};

}  // namespace montecarta::experiments
