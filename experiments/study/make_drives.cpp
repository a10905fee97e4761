// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/make_drives.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/text/list_text.hpp"
#include "experiments/drives/simulated_drive.hpp"
#include "experiments/recordings/recorded_drive.hpp"
#include "experiments/study/fixes.hpp"
#include "experiments/study/known_map.hpp"
#include "experiments/study/read_drives.hpp"
#include "experiments/study/vehicle_and_sensor.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace montecarta::experiments {
namespace {

/// Number of control steps per scan. It must be a whole number, because an integer counter does not
/// drift (EQUATIONS 1).
std::uint32_t steps_per_scan(const Settings& settings) {
  const double ratio =
      settings.number("scenario", "control_rate") / settings.number("scenario", "scan_rate");
  const double whole = std::round(ratio);
  if (whole >= 1.0 && std::abs(ratio - whole) <= 1e-9 * whole)
    return static_cast<std::uint32_t>(whole);
  throw StudyError(
      "{}: scan_rate does not divide control_rate ({} steps a scan): choose rates whose ratio is a "
      "whole number",
      settings.place("scenario", "scan_rate"), to_text(ratio));
}

double min_range_of(const Settings& s) {
  const double least = s.number("scenario", "min_range");
  if (least < s.number("scenario", "max_range")) return least;
  throw StudyError("{}: min_range is not below max_range = {}, so nothing is detected: lower it",
                   s.place("scenario", "min_range"), s.text("scenario", "max_range"));
}

void take_pilot(const Settings& s, Scenario& scenario) {
  const char* in = "scenario";
  const std::string& pilot = s.text(in, "pilot");
  if (pilot == "open_loop") scenario.pilot = Pilot::open_loop;
  if (pilot != "constant") return;
  scenario.pilot = Pilot::constant;
  scenario.drive_time = s.number(in, "drive_time");
  scenario.constant_turn = s.has(in, "constant_steer_deg") ? s.radians(in, "constant_steer_deg")
                                                           : s.radians(in, "constant_yaw_rate_deg");
  if (scenario.drive_time * s.number(in, "scan_rate") >= 1.0) return;
  throw StudyError("{}: drive_time = {} s ends before the first scan: enlarge it, or scan_rate",
                   s.place(in, "drive_time"), s.text(in, "drive_time"));
}

Scenario scenario_of(const Settings& s) {
  Scenario scenario;
  const char* in = "scenario";
  scenario.noise =
      s.text(in, "noise") == "matched" ? NoiseMode::matched : NoiseMode::measured_control;
  take_pilot(s, scenario);
  scenario.map = s.text(in, "map") == "random" ? MapPlacement::random : MapPlacement::fixed;
  scenario.map_shift = s.number(in, "map_shift");
  scenario.loops = static_cast<std::uint32_t>(s.count(in, "loops"));
  scenario.steps_per_scan = steps_per_scan(s);
  scenario.control_rate = s.number(in, "control_rate");
  scenario.vehicle = vehicle_of(s, in);
  scenario.speed = s.number(in, "speed");
  scenario.control = control_noise_of(s, in);
  take_sensor(s, in, 1.0, scenario);
  scenario.max_range = s.number(in, "max_range");
  scenario.min_range = min_range_of(s);
  scenario.field_of_view = s.radians(in, "field_of_view_deg");
  scenario.waypoint_radius = s.number(in, "waypoint_radius");
  scenario.clutter_rate = s.number(in, "clutter_rate");
  scenario.miss_probability = s.number(in, "miss_probability");
  scenario.scans_per_fix = scans_per_fix(s);
  if (scenario.scans_per_fix > 0) scenario.sigma_fix = s.number(in, "sigma_fix");
  scenario.start = {s.number(in, "start_x"), s.number(in, "start_y"),
                    wrap(s.radians(in, "start_heading_deg"))};
  return scenario;
}

/// Refuses known association and the column `association` for a log without identities.
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

/// Returns whether a detection may be of any landmark. A drive on which no landmark was seen has no
/// such detection.
bool has_unidentified(const DriveLog& log) {
  return std::ranges::any_of(log.scans, [](const LoggedScan& scan) {
    return std::ranges::count(scan.detections, Detection::kUnidentified, &Detection::identity) > 0;
  });
}

/// Refuses a scan delay that moves scans before the start: all of these scans would be taken at the
/// start, at one time and with the same random numbers.
void refuse_early_scans(const Settings& s, const DriveLog& log) {
  const double most = log.scans.front().time - log.start_time;
  if (s.number("scenario", "scan_delay") <= most) return;
  throw StudyError(
      "{}: scan_delay = {} puts the first scan before the start of the drive (its pose was unknown "
      "then): at most {} s",
      s.place("scenario", "scan_delay"), s.text("scenario", "scan_delay"), to_text(most));
}

/// Refuses steering for which the model has no solution, because the measured wheel hardly moves.
void refuse_impossible_steering(const Settings& s, const DriveLog& log) {
  const Vehicle vehicle = vehicle_of(s, "belief");
  for (std::size_t i = 0; i < log.odometry.size(); ++i) {
    const Control& control = log.odometry[i].control;
    if (is_beyond_model(vehicle, control)) {
      throw StudyError(
          "{}: odometry record {} steers by {} rad (the vehicle of [belief] then turns about its "
          "measured wheel): correct the log, or wheelbase and wheel_left",
          s.place("belief", "wheel_left"), i + 1, to_text(control[1]));
    }
  }
}

/// Names of controls or of components of a detection: "speed, steer".
std::string names_of(std::span<const Quantity> quantities) {
  std::vector<std::string> names;
  for (const Quantity quantity : quantities) names.emplace_back(component_of(quantity).name);
  return joined(names);
}

/// Throws StudyError unless the assumed vehicle has the controls of the drive.
void refuse_other_controls(const Settings& s, std::span<const Quantity> driven) {
  const std::string given = names_of(driven);
  const std::string believed = names_of(controls_of(vehicle_of(s, "belief")));
  if (given == believed) return;
  throw StudyError(
      "{}: belief.vehicle = {} is controlled by {} (the drive has {}): give belief.vehicle one "
      "that is controlled by these",
      s.place("belief", "vehicle"), s.text("belief", "vehicle"), believed, given);
}

/// Throws StudyError unless the assumed sensor has the components of the detections.
void refuse_other_detections(const Settings& s, std::span<const Quantity> seen) {
  const std::span<const Quantity> believed = components_of(sensor_of(s, "belief"));
  if (std::ranges::equal(seen, believed)) return;
  throw StudyError(
      "{}: belief.sensor = {} has other detections than the drive (it measures {}, the drive has "
      "{}): set belief.sensor to the sensor of the drive",
      s.place("belief", "sensor"), s.text("belief", "sensor"), names_of(believed), names_of(seen));
}

/// The log with only the reference that the study names, if it names one.
DriveLog judged(const Settings& s, DriveLog log) {
  const std::string& name = s.text("scenario", "reference");
  if (!name.empty())
    std::erase_if(log.references, [&](const ReferencePath& path) { return path.name != name; });
  return log;
}

RecordedDrive drive_of(const Settings& s, const DriveLog& log) {
  refuse_other_controls(s, log.controls);
  refuse_other_detections(s, log.components);
  if (has_unidentified(log)) refuse_use_of_identities(s);
  refuse_early_scans(s, log);
  refuse_impossible_steering(s, log);
  return {judged(s, log),
          {s.number("scenario", "max_range"), min_range_of(s)},
          s.number("scenario", "scan_delay")};
}

std::shared_ptr<const DriveSource> several_drives_of(const Study& study) {
  const std::string& place = study.settings.place("scenario", "path");
  std::vector<RecordedDrive> drives;
  for (std::size_t k = 0; k < study.logs.size(); ++k) {
    drives.push_back(at_place(formatted("{}: drive {}", place, k + 1),
                              [&] { return drive_of(study.settings, *study.logs[k]); }));
  }
  return at_place(place, [&] { return std::make_shared<SeveralDrives>(std::move(drives)); });
}

}  // namespace

std::function<std::vector<Eigen::Vector2d>(std::uint64_t run)> own_landmarks_of(
    const Study& study, std::uint64_t seed) {
  if (!study.logs.empty()) return {};
  const Scenario scenario = scenario_of(study.settings);
  if (scenario.map == MapPlacement::fixed) return {};
  return RandomMap(study.world.landmarks, scenario.map_shift, seed);
}

namespace {

std::shared_ptr<const DriveSource> without_prior(const Study& study, std::uint64_t seed) {
  const Settings& s = study.settings;
  if (study.logs.empty()) {
    refuse_other_controls(s, controls_of(vehicle_of(s, "scenario")));
    refuse_other_detections(s, components_of(sensor_of(s, "scenario")));
    return std::make_shared<SimulatedDrive>(study.world, scenario_of(s), seed);
  }
  if (identities_of(study) == 0) refuse_use_of_identities(s);
  if (study.logs.size() > 1) return several_drives_of(study);
  return std::make_shared<RecordedDrive>(drive_of(s, *study.logs.front()));
}

}  // namespace

std::shared_ptr<const DriveSource> drives_of(const Study& study, std::uint64_t seed) {
  const Settings& s = study.settings;
  auto drives = without_prior(study, seed);
  if (!map_is_known(s)) return drives;
  return std::make_shared<DrivesInKnownMap>(std::move(drives), own_landmarks_of(study, seed),
                                            prior_deviations_of(s, "scenario"),
                                            prior_deviations_of(s, "belief"), seed);
}

}  // namespace montecarta::experiments
