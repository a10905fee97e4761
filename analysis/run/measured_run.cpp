// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/measured_run.hpp"

#include "analysis/run/path_at_fixes.hpp"
#include "analysis/run/run_criteria.hpp"
#include "analysis/run/run_metrics.hpp"

#include <Eigen/Core>

namespace montecarta::analysis {
namespace {

/// The true poses at all scans, judged or not.
std::vector<double> whole_path(const RunRows& rows) {
  std::vector<double> path = rows.earlier_truth;
  path.insert(path.end(), rows.truth.begin(), rows.truth.end());
  return path;
}

RunPits measured_pits(const MeasuredRun& run, const RunCriteria& criteria, std::size_t particles) {
  RunPits pits;
  if (criteria.calibrates) {
    const std::span<const Eigen::Vector2d> landmarks(run.rows.landmarks);
    pits = pits_of(run.rows, particles, run.rows.run,
                   landmarks.first(criteria.map.identities_known ? landmarks.size() : 0));
  }
  const NeesRows* nees = run.metrics.leading_nees();
  pits.has_nees = nees != nullptr;
  if (nees != nullptr) pits.nees = nees_pits(nees->value[0], nees->dimension[0]);
  return pits;
}

}  // namespace

void MeasuredRun::measure(const RunCriteria& criteria, std::size_t particles) {
  const DriveCriteria* own = criteria.drives.empty() ? nullptr : &criteria.drives.at(rows.run);
  times = own != nullptr ? own->times : criteria.times;
  metrics.measure(rows, particles, times, criteria.frame);
  proper = proper_scores(rows, particles, metrics.estimates());
  references.clear();
  drives.clear();
  for (const PathAtFixes& fixes : own != nullptr ? own->references : criteria.references) {
    references.push_back(measure_against(fixes, rows.path.mean()));
    if (!fixes.has_errors()) continue;
    const auto scan_rows = own != nullptr ? own->scan_rows : criteria.scan_rows;
    drives.push_back(drive_scores(fixes, scan_rows, rows, particles, criteria.level));
    if (own == nullptr)
      drives.back().errors = {};  // one common drive needs no errors, and there may be many runs
  }
  map.reset();
  if (criteria.map.known && rows.final_map) {
    map = map_scores(*rows.final_map, criteria.map, rows.landmarks, whole_path(rows));
  }
  has_identities = criteria.map.identities_known;
  joint.clear();
  if (!rows.truth.empty()) {
    joint = joint_scores(rows.joint, criteria.joint_scans, rows.truth, rows.landmarks);
  }
  pits = measured_pits(*this, criteria, particles);
  beacons.reset();
  if (criteria.beacons.empty() || !rows.final_map) return;
  if (references.empty() && !rows.truth.empty()) return;  // the truth is the better reference
  const RigidMotion alignment = references.empty() ? RigidMotion() : references.front().alignment;
  beacons = beacon_scores(rows.final_map->places(), criteria.beacons, alignment);
}

}  // namespace montecarta::analysis
