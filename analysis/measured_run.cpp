// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/measured_run.hpp"

namespace montecarta {

Yardsticks yardsticks_of(const ResultFile& file, double level) {
  Yardsticks sticks{file.scan_times(), level, {}, {}};
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
  beacons.reset();
  if (sticks.beacons.empty() || !rows.final_map) return;
  const RigidMotion alignment = references.empty() ? RigidMotion() : references.front().alignment;
  beacons = beacon_scores(*rows.final_map, sticks.beacons, alignment);
}

void CellSums::add(const MeasuredRun& run) {
  sums_.add(run.rows, run.metrics);
  for (std::size_t r = 0; r < references_.size(); ++r) references_[r].add(run.references[r]);
  beacons_.push_back(run.beacons);
}

CellAnalysis CellSums::result() const {
  CellAnalysis cell = sums_.result();
  for (const ReferenceAccumulator& sums : references_) cell.references.push_back(sums.result());
  if (!cell.references.empty()) put_leading_scores(cell.references.front(), cell.scores);
  for (std::size_t i = 0; i < beacons_.size(); ++i) {
    if (!beacons_[i]) continue;
    cell.scores[i].beacons_found = beacons_[i]->found;
    cell.scores[i].beacon_rms = beacons_[i]->rms;
    cell.scores[i].beacon_aligned_rms = beacons_[i]->aligned_rms;
  }
  return cell;
}

}  // namespace montecarta
