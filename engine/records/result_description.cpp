// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/result_description.hpp"

#include "engine/errors.hpp"
#include "engine/records/fingerprint.hpp"
#include "engine/records/record_layout.hpp"

#include <algorithm>
#include <numeric>

namespace montecarta::engine {
namespace {

constexpr std::uint64_t kMostRuns = 10'000'000;  // keeps the bookkeeping of a file in memory

void number_runs(const StudyPlan& plan, ResultDescription& result) {
  if (plan.runs_here() > kMostRuns) {
    throw StudyError(plan.name + ": " + std::to_string(plan.runs_here()) +
                     " runs (one file holds at most " + std::to_string(kMostRuns) +
                     "): lower study.runs, or split the study with --shard I/N");
  }
  result.runs.resize(plan.runs_here());
  std::iota(result.runs.begin(), result.runs.end(), plan.first_run);
}

std::vector<std::pair<double, double>> pairs(const std::vector<Eigen::Vector2d>& points) {
  std::vector<std::pair<double, double>> result;
  for (const Eigen::Vector2d& point : points) result.emplace_back(point.x(), point.y());
  return result;
}

StoredCell describe(const Cell& cell, const StudyPlan& plan) {
  const RecordLayout layout(cell, plan.columns, plan.drives->itinerary());
  return {cell.label, cell.filter, cell.long_name, cell.particles, cell.settings, layout.columns()};
}

void describe_time(const Itinerary& itinerary, bool scans_only, ResultDescription& result) {
  result.scan_steps = itinerary.scan_step;
  for (std::uint32_t step : itinerary.scan_step)
    result.scan_times.push_back(itinerary.step_time[step]);
  result.times = scans_only ? result.scan_times : itinerary.step_time;
  result.scan_rows = itinerary.scan_step;
  if (scans_only) std::iota(result.scan_rows.begin(), result.scan_rows.end(), 0U);
}

OwnDrive own_drive(const Itinerary& itinerary) {
  OwnDrive drive{itinerary.start, {}, itinerary.scan_step, itinerary.references};
  for (const std::uint32_t step : itinerary.scan_step)
    drive.scan_times.push_back(itinerary.step_time[step]);
  return drive;
}

}  // namespace

bool StoredCell::has(std::string_view column) const {
  return std::any_of(columns.begin(), columns.end(),
                     [&](const Column& candidate) { return candidate.name == column; });
}

double ResultDescription::bytes_per_run() const {
  double bytes = has_truth ? static_cast<double>(times.size() * sizeof(Pose)) : 0.0;
  if (own_landmarks) bytes += static_cast<double>(landmarks.size() * sizeof(Eigen::Vector2d));
  for (const StoredCell& cell : cells) {
    for (const Column& column : cell.columns) bytes += static_cast<double>(column.bytes());
  }
  return bytes;
}

ResultDescription describe(const StudyPlan& plan, const TextPairs& provenance) {
  expect(plan.drives != nullptr && plan.last_run > plan.first_run, "a plan without drives or runs");
  ResultDescription result;
  const Itinerary& itinerary = plan.drives->itinerary();
  result.study_name = plan.name;
  result.title = plan.title;
  result.study_text = plan.resolved_text;
  result.study_sha256 = sha256(plan.resolved_text);
  result.seed = plan.seed;
  result.study_runs = plan.runs;
  number_runs(plan, result);
  describe_time(itinerary, plan.columns.scans_only, result);
  if (plan.columns.joint) {
    result.joint_scans = joint_scans_of(itinerary.scans(), plan.columns.joint_scans);
  }
  result.start = itinerary.start;
  result.landmarks = pairs(itinerary.landmarks);
  result.waypoints = pairs(itinerary.waypoints);
  result.references = itinerary.references;
  for (std::size_t run = 0; run < plan.drives->own_drives(); ++run) {
    result.drives.push_back(own_drive(plan.drives->itinerary_of(run)));
  }
  result.has_truth = itinerary.has_truth;
  result.own_landmarks = plan.own_landmarks && !itinerary.landmarks.empty();
  result.scenario = plan.scenario;
  result.provenance = provenance;
  for (const Cell& cell : plan.cells) result.cells.push_back(describe(cell, plan));
  return result;
}

}  // namespace montecarta::engine
