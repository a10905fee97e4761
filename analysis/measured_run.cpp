// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/measured_run.hpp"

#include "analysis/bound/simulated_world.hpp"
#include "analysis/metrics/score_intervals.hpp"

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

void CellSums::add(const MeasuredRun& run) {
  sums_.add(run.rows, run.metrics);
  for (std::size_t r = 0; r < references_.size(); ++r) references_[r].add(run.references[r]);
  beacons_.push_back(run.beacons);
  map_.add(run.map);
  joint_.add(run.joint);
  if (calibrates_) calibration_.add(run.pits);
}

std::vector<RunScores> CellSums::scores() const {
  std::vector<RunScores> scores = sums_.scores();
  if (!references_.empty()) put_leading_scores(references_.front().result(), scores);
  map_.put_scores(scores);
  if (knows_identities_) joint_.put_scores(scores);
  for (std::size_t i = 0; i < beacons_.size(); ++i) {
    if (!beacons_[i]) continue;
    scores[i].beacons_found = beacons_[i]->found;
    scores[i].beacon_rms = beacons_[i]->rms;
    scores[i].beacon_aligned_rms = beacons_[i]->aligned_rms;
  }
  return scores;
}

CellAnalysis CellSums::result() {
  CellAnalysis cell = sums_.result();
  for (const ReferenceAccumulator& sums : references_) cell.references.push_back(sums.result());
  cell.map = map_.result(level_, knows_landmarks_);
  cell.joint = joint_.result(level_, knows_identities_);
  cell.calibration = calibration_.result(times_, level_);
  cell.scores = scores();
  put_score_intervals(cell, level_);
  return cell;
}

std::vector<MeasuredRun> slots_for(const Parallel& parallel) {
  return std::vector<MeasuredRun>(
      parallel.threads() == 1 ? 1 : 4 * static_cast<std::size_t>(parallel.threads()));
}

void add_runs(const RunReader& reader, std::span<const std::size_t> runs, std::size_t particles,
              const Yardsticks& sticks, const Parallel& parallel, std::vector<MeasuredRun>& slots,
              CellSums& sums) {
  for (std::size_t first = 0; first < runs.size(); first += slots.size()) {
    const std::size_t here = std::min(slots.size(), runs.size() - first);
    parallel.for_each(here, [&](std::size_t k) {
      reader.read(runs[first + k], slots[k].rows, slots[k].scratch);
      slots[k].measure(sticks, particles);
    });
    for (std::size_t k = 0; k < here; ++k) sums.add(slots[k]);
  }
}

}  // namespace montecarta
