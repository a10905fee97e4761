// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/criteria_of.hpp"

#include "analysis/run/imported_state.hpp"
#include "analysis/run/run_reader.hpp"
#include "analysis/run/simulated_world.hpp"
#include "analysis/run/study_facts.hpp"

#include <algorithm>
#include <cstddef>

namespace montecarta::analysis {
namespace {

bool says(const ResultFile& file, const char* setting, const char* value) {
  return std::ranges::count(file.scenario(), TextPairs::value_type{setting, value}) > 0;
}

/// Returns whether filters believe the noise that is simulated; only then can a filter be
/// calibrated.
bool noise_is_matched(const ResultFile& file) {
  return file.has_truth() && says(file, "noise", "matched");
}

std::vector<double> true_headings(const ResultFile& file, std::size_t run) {
  std::vector<double> truth(3 * file.times().size()), headings;
  file.read_truth(run, truth);
  for (std::size_t k = 2; k < truth.size(); k += 3) headings.push_back(truth[k]);
  return headings;
}

bool are_true_headings_the_same(const ResultFile& file) {
  std::vector<double> first;
  for (std::size_t run = 0; file.has_truth() && run < file.runs().size(); ++run) {
    const std::vector<double> headings = true_headings(file, run);
    if (run == 0) first = headings;
    if (headings != first) return false;
  }
  return true;
}

/// Chooses the frame by the scenario, which states how the truth is simulated, even in a shard of
/// one run. Files without that statement, such as those of imported estimates, hold all of their
/// runs, whose headings are compared instead.
ErrorFrame error_frame_of(const ResultFile& file) {
  if (noise_is_matched(file)) return ErrorFrame::of_estimate;
  const bool is_same = says(file, "noise", "measured-control") || are_true_headings_the_same(file);
  return is_same ? ErrorFrame::of_truth : ErrorFrame::of_estimate;
}

/// Returns the criteria for the maps of a drive with known truth. Recorded drives are judged by
/// their beacons.
MapCriteria map_criteria_of(const ResultFile& file) {
  MapCriteria criteria;
  if (!file.has_truth()) return criteria;
  criteria.known = !file.landmarks().empty();
  const auto world = simulated_world_of(file);
  if (world && !world->prior) criteria.view = world->view;  // a known map has all landmarks
  criteria.is_exact = map_is_known(file) && says(file, "belief.map_sigma_m", "0");
  criteria.identities_known = says(file, "association.kind", "known");
  return criteria;
}

DriveCriteria criteria_of_drive(const RunDrive& drive, const Eigen::Matrix3d& start_covariance) {
  DriveCriteria criteria{drive.scan_times, drive.scan_rows, {}};
  for (const ReferencePath& path : drive.references) {
    criteria.references.emplace_back(path, drive.row_times, drive.start, start_covariance);
  }
  return criteria;
}

/// Adds how the errors of imported estimates are judged.
void add_imported(const ResultFile& file, const ImportedState& imported, RunCriteria& criteria) {
  criteria.components = imported.components;
  criteria.units = imported.units;
  criteria.has_own_scans = imported.are_innovations() || !imported.windows.empty();
  if (imported.are_innovations()) {
    criteria.innovation_components = imported.components.size();
    criteria.tests_together = 2 * sensors_of(file);
  }
  criteria.share_of_runs = 1.0;  // a file of imported estimates is no shard
}

}  // namespace

RunCriteria criteria_of(const ResultFile& file, double level, double within) {
  const std::size_t first = judged_scans_of(file).first;
  RunCriteria criteria{.times = std::span(file.scan_times()).subspan(first),
                       .level = level,
                       .within = within,
                       .references = {},
                       .beacons = {},
                       .map = map_criteria_of(file),
                       .joint_scans = judged_joint_scans(file),
                       .scan_rows = std::span(file.scan_rows()).subspan(first),
                       .frame = error_frame_of(file),
                       .calibrates = noise_is_matched(file),
                       .runs_at_analyses = study_facts_of(file).runs_at_analyses,
                       .share_of_runs = static_cast<double>(file.runs().size()) /
                                        static_cast<double>(file.study_runs()),
                       .components = {kErrorComponents.begin(), kErrorComponents.end()}};
  const ImportedState imported =
      file.cells().empty() ? ImportedState() : imported_state(file.cells().front());
  criteria.has_same_measurements =
      !file.has_errors() && !imported.is_imported() && file.description().drives.empty();
  if (imported.is_imported()) add_imported(file, imported, criteria);
  const Eigen::Matrix3d start = believed_prior_of(file).start_covariance();
  for (const ReferencePath& path : file.references()) {
    criteria.references.emplace_back(path, file.times(), file.description().start, start);
  }
  for (std::size_t run = 0; run < file.description().drives.size(); ++run) {
    criteria.drives.push_back(criteria_of_drive(drive_of_run(file, run), start));
  }
  if (!criteria.drives.empty()) criteria.references = criteria.drives.front().references;
  criteria.beacons = file.landmarks();
  return criteria;
}

}  // namespace montecarta::analysis
