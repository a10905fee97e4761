// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/measured_run.hpp"

#include "analysis/metrics/simulated_world.hpp"

#include <algorithm>

namespace montecarta {
namespace {

bool says(const ResultFile& file, const char* setting, const char* value) {
  return std::ranges::count(file.scenario(), TextPairs::value_type{setting, value}) > 0;
}

/// Only then are estimates drawn as filters believe; else no filter can be calibrated.
bool noise_is_matched(const ResultFile& file) {
  return file.has_truth() && says(file, "noise", "matched");
}

/// Of a drive whose truth is known; a recorded one is judged by its beacons.
MapYardstick map_yardstick_of(const ResultFile& file) {
  MapYardstick sticks;
  if (!file.has_truth()) return sticks;
  sticks.known = !file.landmarks().empty();
  if (const auto world = simulated_world_of(file)) sticks.view = world->view;
  sticks.identities_known = says(file, "association.kind", "known");
  return sticks;
}

}  // namespace

Yardsticks yardsticks_of(const ResultFile& file, double level) {
  const std::size_t scans = file.has_truth() ? file.scan_times().size() : 0;
  Yardsticks sticks{.times = file.scan_times(),
                    .level = level,
                    .references = {},
                    .beacons = {},
                    .map = map_yardstick_of(file),
                    .joint_scans = file.description().joint_scans,
                    .walks = BandWalks(scans),
                    .calibrates = noise_is_matched(file)};
  for (const ReferencePath& path : file.references()) {
    sticks.references.emplace_back(path, file.times(), file.description().start);
  }
  for (const auto& [x, y] : file.landmarks()) sticks.beacons.emplace_back(x, y);
  return sticks;
}

void MeasuredRun::measure(const Yardsticks& sticks, std::size_t particles) {
  metrics.measure(rows, particles, sticks.times);
  references.clear();
  for (const PathAtFixes& fixes : sticks.references) {
    references.push_back(measure_against(fixes, rows.path));
  }
  map.reset();
  if (sticks.map.known && rows.final_map) {
    map = map_scores(*rows.final_map, sticks.map, rows.landmarks, rows.truth);
  }
  has_identities = sticks.map.identities_known;
  joint.clear();
  if (!rows.truth.empty()) {
    joint = joint_scores(rows.joint, sticks.joint_scans, rows.truth, rows.landmarks);
  }
  if (sticks.calibrates)
    pits = pits_of(rows, rows.run,
                   sticks.map.identities_known ? std::span<const Eigen::Vector2d>(rows.landmarks)
                                               : std::span<const Eigen::Vector2d>());
  beacons.reset();
  if (sticks.beacons.empty() || !rows.final_map) return;
  if (references.empty() && !rows.truth.empty()) return;  // the truth is the better yardstick
  const RigidMotion alignment = references.empty() ? RigidMotion() : references.front().alignment;
  beacons = beacon_scores(rows.final_map->places(), sticks.beacons, alignment);
}

}  // namespace montecarta
