// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/recordings/log_of_drive.hpp"

#include "engine/errors.hpp"
#include "experiments/recordings/log_csv_names.hpp"

#include <algorithm>
#include <utility>

namespace montecarta::experiments {
namespace {

/// A control holds from its time to that of the next one; the last record ends the last step.
std::vector<Odometry> odometry_rows(const Itinerary& itinerary, const Drive& drive) {
  std::vector<Odometry> odometry;
  double begin = 0.0;
  for (std::size_t k = 0; k < itinerary.steps(); ++k) {
    odometry.push_back({begin, drive.controls[k]});
    begin = itinerary.step_time[k];
  }
  odometry.push_back({begin, {}});
  return odometry;
}

LoggedScan scan_of(double time, Scan scan, Identities identities) {
  LoggedScan logged{time, {scan.begin(), scan.end()}};
  if (identities == Identities::told) return logged;
  for (Detection& detection : logged.detections) detection.identity = Detection::kUnidentified;
  return logged;
}

ReferencePath truth_path(const Itinerary& itinerary, const Drive& drive) {
  ReferencePath path{
      .name = log_csv::kLeading, .time = itinerary.step_time, .position = {}, .heading = {}};
  for (const Pose& pose : drive.truth) {
    path.position.emplace_back(pose.x, pose.y);
    path.heading.push_back(pose.heading);
  }
  return path;
}

}  // namespace

DriveLog log_of(const Itinerary& itinerary, const Drive& drive,
                std::span<const ControlName> controls, std::vector<Eigen::Vector2d> landmarks,
                Identities identities) {
  expect(itinerary.has_truth, "a log is made of a drive whose truth is unknown");
  DriveLog log;
  log.start = itinerary.start;
  log.controls = controls;
  log.odometry = odometry_rows(itinerary, drive);
  for (std::size_t s = 0; s < itinerary.scans(); ++s) {
    log.scans.push_back(
        scan_of(itinerary.step_time[itinerary.scan_step[s]], drive.scan(s), identities));
  }
  log.references.push_back(truth_path(itinerary, drive));
  log.landmarks = std::move(landmarks);
  return log;
}

}  // namespace montecarta::experiments
