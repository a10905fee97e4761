// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/recordings/drive_log.hpp"

namespace montecarta {

/// A recorded drive as the engine takes it: odometry, scans and fixes merged by their times, which
/// are counted from the first event. A step ends wherever odometry or a scan comes in, so that no
/// step has two scans, and drives by the odometry that came in last. Before the first odometry the
/// vehicle stands. All runs are the same: they differ by the filter's random numbers alone.
class RecordedDrive final : public DriveSource {
 public:
  /// Detections beyond `max_range` [m] are left out. The log must have passed check_log().
  RecordedDrive(const DriveLog& log, double max_range);

  const Itinerary& itinerary() const override { return itinerary_; }
  void generate(std::uint64_t run, Drive& drive) const override;

 private:
  void merge(const DriveLog& log, double max_range);
  void end_step(double time, const Control& control);
  void take_scan(const LoggedScan& scan, double max_range);

  Itinerary itinerary_;
  Drive drive_;
};

}  // namespace montecarta
