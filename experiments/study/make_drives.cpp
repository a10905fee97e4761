// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/make_drives.hpp"

#include "engine/errors.hpp"
#include "experiments/drives/simulated_drive.hpp"
#include "experiments/recordings/recorded_drive.hpp"
#include "experiments/text/numbers.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::experiments {
namespace {

/// Scans happen at every so-many-th control step: a whole number, for an integer counter never
/// drifts (EQUATIONS 1).
std::uint32_t steps_per_scan(const Settings& settings) {
  const double ratio =
      settings.number("scenario", "control_rate") / settings.number("scenario", "scan_rate");
  const double whole = std::round(ratio);
  if (whole >= 1.0 && std::abs(ratio - whole) <= 1e-9 * whole)
    return static_cast<std::uint32_t>(whole);
  throw StudyError(settings.place("scenario", "scan_rate") +
                   ": scan_rate does not divide control_rate (" + to_text(ratio) +
                   " steps a scan): choose rates whose ratio is a whole number");
}

Scenario scenario_of(const Settings& s) {
  Scenario scenario;
  const char* in = "scenario";
  scenario.noise =
      s.text(in, "noise") == "matched" ? NoiseMode::matched : NoiseMode::measured_control;
  scenario.map = s.text(in, "map") == "random" ? MapPlacement::random : MapPlacement::fixed;
  scenario.map_shift = s.number(in, "map_shift");
  scenario.loops = static_cast<std::uint32_t>(s.count(in, "loops"));
  scenario.steps_per_scan = steps_per_scan(s);
  scenario.control_rate = s.number(in, "control_rate");
  scenario.vehicle = vehicle_of(s, in);
  scenario.speed = s.number(in, "speed");
  scenario.sigma_speed = s.number(in, "sigma_speed");
  scenario.sigma_steer = s.radians(in, "sigma_steer_deg");
  scenario.sigma_range = s.number(in, "sigma_range");
  scenario.sigma_bearing = s.radians(in, "sigma_bearing_deg");
  scenario.max_range = s.number(in, "max_range");
  scenario.field_of_view = s.radians(in, "field_of_view_deg");
  scenario.waypoint_radius = s.number(in, "waypoint_radius");
  scenario.steer_limit = s.radians(in, "steer_limit_deg");
  scenario.steer_rate_limit = s.radians(in, "steer_rate_limit_deg");
  scenario.clutter_rate = s.number(in, "clutter_rate");
  scenario.miss_probability = s.number(in, "miss_probability");
  scenario.start = {s.number(in, "start_x"), s.number(in, "start_y"),
                    wrap(s.radians(in, "start_heading_deg"))};
  return scenario;
}

/// A log whose detections nobody identified leaves that to the filters, and nothing to count.
void refuse_use_of_identities(const Settings& s) {
  if (s.text("association", "kind") == "known") {
    throw StudyError(s.place("association", "kind") +
                     ": association.kind = known (detections of this drive carry no identity): "
                     "set it to nearest");
  }
  if (s.lists("record", "columns", "association")) {
    throw StudyError(s.place("record", "columns") +
                     ": association (detections of this drive carry no identity to count by): "
                     "leave it out");
  }
}

/// Scans before the start would all be taken there, at one time and with the same random numbers.
void refuse_early_scans(const Study& study) {
  const Settings& s = study.settings;
  const double most = study.log->scans.front().time - study.log->start_time;
  if (s.number("scenario", "scan_delay") <= most) return;
  throw StudyError(s.place("scenario", "scan_delay") +
                   ": scan_delay = " + s.text("scenario", "scan_delay") +
                   " puts the first scan before the start of the drive (nobody knows where that "
                   "was): at most " +
                   to_text(most) + " s");
}

/// Steering at which the measured wheel all but stands still, beyond which the model has no answer.
void refuse_impossible_steering(const Study& study) {
  const Vehicle vehicle = vehicle_of(study.settings, "belief");
  for (std::size_t i = 0; i < study.log->odometry.size(); ++i) {
    const double steer = study.log->odometry[i].control.steer;
    if (turns_about_its_wheel(vehicle, steer)) {
      throw StudyError(
          study.settings.place("belief", "wheel_left") + ": odometry record " +
          std::to_string(i + 1) + " steers by " + to_text(steer) +
          " rad (the vehicle of [belief] then turns about its measured wheel): correct "
          "the log, or wheelbase and wheel_left");
    }
  }
}

/// The log with the reference alone that the study judges by, if it names one.
DriveLog judged(const Study& study) {
  DriveLog log = *study.log;
  const std::string& name = study.settings.text("scenario", "reference");
  if (!name.empty())
    std::erase_if(log.references, [&](const ReferencePath& path) { return path.name != name; });
  return log;
}

}  // namespace

Vehicle vehicle_of(const Settings& s, const char* in) {
  return {.kind = s.text(in, "vehicle") == "rear_wheel" ? Vehicle::Kind::rear_wheel
                                                        : Vehicle::Kind::front_axle,
          .wheelbase = s.number(in, "wheelbase"),
          .wheel_left = s.number(in, "wheel_left"),
          .sensor_ahead = s.number(in, "sensor_ahead"),
          .sensor_left = s.number(in, "sensor_left")};
}

std::size_t identities_of(const Study& study) {
  if (study.log == nullptr) return study.world.landmarks.size();
  std::int32_t last = -1;
  for (const LoggedScan& scan : study.log->scans) {
    for (const Detection& detection : scan.detections) last = std::max(last, detection.identity);
  }
  return last < 0 ? 0 : static_cast<std::size_t>(last) + 1;
}

std::function<std::vector<Eigen::Vector2d>(std::uint64_t run)> own_landmarks_of(
    const Study& study, std::uint64_t seed) {
  if (study.log != nullptr) return {};
  const Scenario scenario = scenario_of(study.settings);
  if (scenario.map == MapPlacement::fixed) return {};
  return RandomMap(study.world.landmarks, scenario.map_shift, seed);
}

std::shared_ptr<const DriveSource> drives_of(const Study& study, std::uint64_t seed) {
  const Settings& s = study.settings;
  if (study.log == nullptr)
    return std::make_shared<SimulatedDrive>(study.world, scenario_of(s), seed);
  if (identities_of(study) == 0) refuse_use_of_identities(s);
  refuse_early_scans(study);
  refuse_impossible_steering(study);
  return std::make_shared<RecordedDrive>(judged(study), s.number("scenario", "max_range"),
                                         s.number("scenario", "scan_delay"));
}

}  // namespace montecarta::experiments
