// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/recordings/recorded_drive.hpp"

#include "engine/errors.hpp"

#include <algorithm>

namespace montecarta {
namespace {

double first_event(const DriveLog& log) {
  const double odometry = log.odometry.front().time;
  return log.scans.empty() ? odometry : std::min(odometry, log.scans.front().time);
}

}  // namespace

RecordedDrive::RecordedDrive(const DriveLog& log, double max_range) {
  expect(!log.odometry.empty(), "a drive without odometry");
  itinerary_.start = log.start;
  itinerary_.has_truth = false;
  itinerary_.landmarks = log.landmarks;
  itinerary_.references = log.references;
  const double origin = first_event(log);
  for (ReferencePath& path : itinerary_.references) {
    for (double& time : path.time) time -= origin;
  }
  merge(log, max_range);
}

void RecordedDrive::merge(const DriveLog& log, double max_range) {
  const double origin = first_event(log);
  const std::vector<Odometry>& odometry = log.odometry;
  drive_.scan_begin.assign(1, 0);
  Control control;  // the vehicle stands until it says otherwise
  std::size_t o = 0;
  for (const LoggedScan& scan : log.scans) {
    for (; o < odometry.size() && odometry[o].time < scan.time; ++o) {
      end_step(odometry[o].time - origin, control);
      control = odometry[o].control;
    }
    end_step(scan.time - origin, control);
    take_scan(scan, max_range);
  }
  for (; o < odometry.size(); ++o) {
    end_step(odometry[o].time - origin, control);
    control = odometry[o].control;
  }
}

/// Nothing happens between two events at one time; only the first event of all may be at zero, and
/// counts where it is a scan.
void RecordedDrive::end_step(double time, const Control& control) {
  const double before = itinerary_.step_time.empty() ? 0.0 : itinerary_.step_time.back();
  if (time <= before) return;
  itinerary_.step_time.push_back(time);
  drive_.controls.push_back(control);
}

void RecordedDrive::take_scan(const LoggedScan& scan, double max_range) {
  if (itinerary_.step_time.empty()) {  // before the vehicle first moves
    itinerary_.step_time.push_back(0.0);
    drive_.controls.emplace_back();
  }
  itinerary_.scan_step.push_back(static_cast<std::uint32_t>(itinerary_.steps() - 1));
  std::ranges::copy_if(scan.detections, std::back_inserter(drive_.detections),
                       [&](const Detection& d) { return d.range <= max_range; });
  drive_.scan_begin.push_back(static_cast<std::uint32_t>(drive_.detections.size()));
}

void RecordedDrive::generate(std::uint64_t /*run*/, Drive& drive) const { drive = drive_; }

}  // namespace montecarta
