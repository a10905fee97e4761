// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/recordings/recorded_drive.hpp"

#include <algorithm>
#include <iterator>
#include <limits>

namespace montecarta::experiments {
RecordedDrive::RecordedDrive(const DriveLog& log, const Reach& reach, double scan_delay) {
  itinerary_.start = {log.start.x, log.start.y, wrap(log.start.heading)};
  itinerary_.has_truth = false;
  itinerary_.moving_controls = moving_controls(log.controls);
  itinerary_.landmarks = log.landmarks;
  itinerary_.references = log.references;
  for (ReferencePath& path : itinerary_.references) {
    for (double& time : path.time) time -= log.start_time;
  }
  merge(log, reach, scan_delay);
}

void RecordedDrive::merge(const DriveLog& log, const Reach& reach, double scan_delay) {
  drive_.scan_begin.assign(1, 0);
  Control control;  // the vehicle stands until it says otherwise
  auto odometry = log.odometry.begin();
  const auto drive_until = [&](double time) {
    for (; odometry != log.odometry.end() && odometry->time < time; ++odometry) {
      end_step(odometry->time - log.start_time, control);
      control = odometry->control;
    }
  };
  for (const LoggedScan& scan : log.scans) {
    const double time = scan.time - scan_delay;
    drive_until(time);
    end_step(time - log.start_time, control);
    take_scan(scan, log.components, reach);
  }
  drive_until(std::numeric_limits<double>::infinity());
}

/// Nothing happens between two events at one time, and nothing is known of what came before the
/// start but the odometry that still holds then.
void RecordedDrive::end_step(double time, const Control& control) {
  const double before = itinerary_.step_time.empty() ? 0.0 : itinerary_.step_time.back();
  if (time <= before) return;
  itinerary_.step_time.push_back(time);
  drive_.controls.push_back(control);
}

void RecordedDrive::take_scan(const LoggedScan& scan, std::span<const Quantity> components,
                              const Reach& reach) {
  if (itinerary_.step_time.empty()) {  // at the start
    itinerary_.step_time.push_back(0.0);
    drive_.controls.emplace_back();
  }
  itinerary_.scan_step.push_back(static_cast<std::uint32_t>(itinerary_.steps() - 1));
  std::ranges::copy_if(
      scan.detections, std::back_inserter(drive_.detections), [&](const Detection& d) {
        const double distance = distance_in(components, d).value_or(reach.max_range);
        return distance <= reach.max_range && distance >= reach.min_range;
      });
  drive_.scan_begin.push_back(static_cast<std::uint32_t>(drive_.detections.size()));
}

void RecordedDrive::generate(std::uint64_t /*run*/, Drive& drive) const { drive = drive_; }

}  // namespace montecarta::experiments
