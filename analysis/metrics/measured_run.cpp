// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/measured_run.hpp"

#include "analysis/data/looks.hpp"
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

}  // namespace

RunCriteria criteria_of(const ResultFile& file, double level, double within) {
  const std::size_t scans = file.has_truth() ? file.scan_times().size() : 0;
  RunCriteria criteria{.times = file.scan_times(),
                       .level = level,
                       .within = within,
                       .references = {},
                       .beacons = {},
                       .map = map_criteria_of(file),
                       .joint_scans = file.description().joint_scans,
                       .walks = BandWalks(scans),
                       .calibrates = noise_is_matched(file),
                       .look_level = {},
                       .printed = printed_in(file.study_text())};
  const auto looks = looks_in(file.study_text(), file.study_runs());
  if (looks.size() > 1) criteria.look_level = level_of_a_look(level, looks.size());
  for (const ReferencePath& path : file.references()) {
    criteria.references.emplace_back(path, file.times(), file.description().start);
  }
  for (const auto& [x, y] : file.landmarks()) criteria.beacons.emplace_back(x, y);
  return criteria;
}

void MeasuredRun::measure(const RunCriteria& criteria, std::size_t particles) {
  metrics.measure(rows, particles, criteria.times);
  references.clear();
  for (const PathAtFixes& fixes : criteria.references) {
    references.push_back(measure_against(fixes, rows.path));
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
