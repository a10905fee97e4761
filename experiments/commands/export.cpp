// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/frame.hpp"
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "experiments/commands/arguments.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/recordings/log_csv.hpp"
#include "experiments/recordings/recorded_drive.hpp"
#include "experiments/study/fixes.hpp"
#include "experiments/study/vehicle_and_sensor.hpp"

#include <algorithm>
#include <iostream>
#include <vector>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

fs::path output_of(const Arguments& arguments) {
  fs::path directory = arguments.text("output").value();
  if (!fs::exists(directory) || (fs::is_directory(directory) && fs::is_empty(directory)))
    return directory;
  throw StudyError(directory.string() +
                   ": not a new folder (other files would be taken for drives of this study): "
                   "name another");
}

/// A name like "run_0012", with leading zeros, so that names sort like numbers.
std::string name_of_run(std::uint64_t run, std::uint64_t runs) {
  const std::size_t digits = std::max<std::size_t>(4, std::to_string(runs - 1).size());
  std::string number = std::to_string(run);
  number.insert(0, digits - number.size(), '0');
  return "run_" + number;
}

/// The sections [belief] and [association] of a study, which a filter assumes, as the text of a
/// file.
std::string belief_text(const Study& study) {
  std::string text;
  for (const char* section : {"belief", "association"}) {
    text += formatted("[{}]\n", section);
    for (const auto& [key, value] : stated_settings(study.settings, section))
      text += formatted("{} = {}\n", key, value);
  }
  return text;
}

std::vector<Eigen::Vector2d> places_in(const std::vector<LandmarkEstimate>& map) {
  std::vector<Eigen::Vector2d> places;
  for (const LandmarkEstimate& landmark : map) places.push_back(landmark.mean);
  return places;
}

/// A CSV log has no place for fixes of the position.
void refuse_fixes_in_log(const Study& study) {
  if (scans_per_fix(study.settings) == 0) return;
  throw StudyError(study.settings.place("scenario", "fixes") +
                   ": fixes = position (a CSV log holds detections of landmarks only, so that the "
                   "fixes would be lost): add --set scenario.fixes=none, which leaves everything "
                   "else as it is");
}

}  // namespace

int export_command(const Arguments& arguments) {
  const Study study = study_of(arguments);
  if (!study.logs.empty()) {
    throw StudyError(arguments.operands().front() +
                     ": the drive of this study was recorded (it is the same in all runs, and a "
                     "CSV log already): give the folder of scenario.path to the other program");
  }
  refuse_fixes_in_log(study);
  const fs::path folder = output_of(arguments);
  const StudyPlan plan = plan_of(study, arguments);
  const bool known = study.settings.text("association", "kind") == "known";
  const Itinerary& itinerary = plan.drives->itinerary();
  const auto controls = controls_of(vehicle_of(study.settings, "scenario"));
  Drive drive;
  for (std::uint64_t run = plan.first_run; run < plan.last_run; ++run) {
    plan.drives->generate(run, drive);
    DriveLog log = log_of(itinerary, drive, controls,
                          plan.own_landmarks ? plan.own_landmarks(run) : itinerary.landmarks,
                          known ? Identities::told : Identities::withheld);
    log.components = components_of(sensor_of(study.settings, "scenario"));
    const std::string name = name_of_run(run, plan.runs);
    if (drive.prior) log.start = drive.prior->pose.mean;
    write_log_csv(log, folder / "runs" / name, folder / "truth" / name);
    if (drive.prior) write_landmarks_csv(places_in(drive.prior->map), folder / "runs" / name);
  }
  write_text(folder / "belief.ini", belief_text(study));
  write_text(folder / "truth" / "study.ini", plan.resolved_text);
  std::cerr << "montecarta: " << plan.runs_here() << " drives, stored in "
            << (folder / "runs").string() << ", their truth in " << (folder / "truth").string()
            << "\n";
  return kDone;
}

}  // namespace montecarta::experiments
