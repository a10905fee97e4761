// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/measured_run.hpp"

#include "analysis/data/run_reader.hpp"
#include "analysis/data/study_settings.hpp"
#include "analysis/metrics/simulated_world.hpp"
#include "analysis/statistics/group_sequential.hpp"

#include <algorithm>

namespace montecarta::analysis {
namespace {

bool says(const ResultFile& file, const char* setting, const char* value) {
  return std::ranges::count(file.scenario(), TextPairs::value_type{setting, value}) > 0;
}

/// Only then are estimates drawn as filters believe; else no filter can be calibrated.
bool noise_is_matched(const ResultFile& file) {
  return file.has_truth() && says(file, "noise", "matched");
}

/// Of a drive whose truth is known; a recorded one is judged by its beacons.
MapCriteria map_criteria_of(const ResultFile& file) {
  MapCriteria criteria;
  if (!file.has_truth()) return criteria;
  criteria.known = !file.landmarks().empty();
  if (const auto world = simulated_world_of(file)) criteria.view = world->view;
  criteria.identities_known = says(file, "association.kind", "known");
  return criteria;
}

DriveCriteria criteria_of_drive(const MetDrive& drive) {
  DriveCriteria criteria{drive.scan_times, {}, {}};
  for (const ReferencePath& path : drive.references) {
    criteria.references.emplace_back(path, drive.scan_times, drive.start);
    if (path.covariance.empty()) continue;
    criteria.judged_fixes.emplace_back(path, drive.scan_times, drive.start);
  }
  return criteria;
}

}  // namespace

RunCriteria criteria_of(const ResultFile& file, double level, double within) {
  const std::size_t scans = file.has_errors() ? file.scan_times().size() : 0;
  RunCriteria criteria{.times = file.scan_times(),
                       .level = level,
                       .within = within,
                       .references = {},
                       .beacons = {},
                       .map = map_criteria_of(file),
                       .joint_scans = file.description().joint_scans,
                       .walks = BandWalks(scans),
                       .calibrates = noise_is_matched(file),
                       .look_level = {}};
  const auto looks = looks_in(file.study_text(), file.study_runs());
  if (looks.size() > 1) criteria.look_level = level_of_a_look(level, looks.size());
  for (const ReferencePath& path : file.references()) {
    criteria.references.emplace_back(path, file.times(), file.description().start);
    if (path.covariance.empty()) continue;
    criteria.judged_fixes.emplace_back(path, file.scan_times(), file.description().start);
  }
  for (std::size_t run = 0; run < file.description().drives.size(); ++run) {
    criteria.drives.push_back(criteria_of_drive(drive_met_by(file, run)));
  }
  if (!criteria.drives.empty()) {
    criteria.references = criteria.drives.front().references;
    criteria.judged_fixes = criteria.drives.front().judged_fixes;
  }
  for (const auto& [x, y] : file.landmarks()) criteria.beacons.emplace_back(x, y);
  return criteria;
}

void MeasuredRun::measure(const RunCriteria& criteria, std::size_t particles) {
  const DriveCriteria* own = criteria.drives.empty() ? nullptr : &criteria.drives.at(rows.run);
  const std::span<const double> times = own != nullptr ? own->times : criteria.times;
  metrics.measure(rows, particles, times);
  references.clear();
  for (const PathAtFixes& fixes : own != nullptr ? own->references : criteria.references) {
    references.push_back(measure_against(fixes, rows.path));
  }
  drives.clear();
  for (const PathAtFixes& fixes : own != nullptr ? own->judged_fixes : criteria.judged_fixes) {
    drives.push_back(drive_scores(fixes, times, rows, particles, criteria.level));
    if (own == nullptr)
      drives.back().errors = {};  // one drive needs none, and there may be many runs
  }
  map.reset();
  if (criteria.map.known && rows.final_map) {
    map = map_scores(*rows.final_map, criteria.map, rows.landmarks, rows.truth);
  }
  has_identities = criteria.map.identities_known;
  joint.clear();
  if (!rows.truth.empty()) {
    joint = joint_scores(rows.joint, criteria.joint_scans, rows.truth, rows.landmarks);
  }
  if (criteria.calibrates)
    pits = pits_of(rows, particles, rows.run,
                   criteria.map.identities_known ? std::span<const Eigen::Vector2d>(rows.landmarks)
                                                 : std::span<const Eigen::Vector2d>());
  beacons.reset();
  if (criteria.beacons.empty() || !rows.final_map) return;
  if (references.empty() && !rows.truth.empty()) return;  // the truth is the better reference
  const RigidMotion alignment = references.empty() ? RigidMotion() : references.front().alignment;
  beacons = beacon_scores(rows.final_map->places(), criteria.beacons, alignment);
}

}  // namespace montecarta::analysis
