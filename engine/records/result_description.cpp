// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/result_description.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/fingerprint.hpp"
#include "engine/records/result_format.hpp"
#include "engine/records/run_record.hpp"
#include "engine/text/list_text.hpp"

#include <algorithm>
#include <numeric>
#include <sstream>

namespace montecarta::engine {
namespace {

// Limit of the memory for the bookkeeping of a file.
constexpr std::uint64_t kMostRuns = 10'000'000;

void number_runs(const StudyPlan& plan, ResultDescription& result) {
  if (plan.runs_here() > kMostRuns) {
    throw StudyError(
        "{}: {} runs (one file holds at most {}): lower study.runs, or split the study with "
        "--shard I/N",
        plan.name, plan.runs_here(), kMostRuns);
  }
  result.runs.resize(plan.runs_here());
  std::iota(result.runs.begin(), result.runs.end(), plan.first_run);
}

StoredCell describe(const Cell& cell, const StudyPlan& plan) {
  const RecordLayout layout(cell, plan.columns, plan.drives->itinerary(),
                            plan.columns.full_runs > 0 ? Detail::full : Detail::usual);
  return {cell.label,    cell.filter,      cell.long_name,        cell.particles,
          cell.settings, layout.columns(), layout.usual_columns()};
}

void describe_time(const Itinerary& itinerary, bool scans_only, ResultDescription& result) {
  result.scan_steps = itinerary.scan_step;
  for (std::uint32_t step : itinerary.scan_step)
    result.scan_times.push_back(itinerary.step_time[step]);
  result.times = scans_only ? result.scan_times : itinerary.step_time;
  result.scan_rows = itinerary.scan_step;
  if (scans_only) std::iota(result.scan_rows.begin(), result.scan_rows.end(), 0U);
}

OwnDrive own_drive(const Itinerary& itinerary, bool scans_only) {
  OwnDrive drive{itinerary.start, {}, itinerary.scan_step, itinerary.references};
  if (!scans_only) drive.step_times = itinerary.step_time;
  for (const std::uint32_t step : itinerary.scan_step)
    drive.scan_times.push_back(itinerary.step_time[step]);
  return drive;
}

}  // namespace

bool StoredCell::has(std::string_view column) const {
  return std::ranges::count(usual(), column, &Column::name) > 0;
}

const Column* StoredCell::find(std::string_view column) const {
  const auto found = std::ranges::find(columns, column, &Column::name);
  return found == columns.end() ? nullptr : &*found;
}

std::string StoredCell::dataset_of(std::size_t c) const {
  return formatted("cells/{}/{}{}", label,
                   c < usual_columns ? "" : std::string(format::kFull) + "/", columns[c].name);
}

std::size_t ResultDescription::full_runs_here() const {
  return static_cast<std::size_t>(std::ranges::lower_bound(runs, full_runs) - runs.begin());
}

double ResultDescription::bytes() const {
  double of_run = has_truth ? static_cast<double>(times.size() * sizeof(Pose)) : 0.0;
  if (own_landmarks) of_run += static_cast<double>(landmarks.size() * sizeof(Eigen::Vector2d));
  double of_full_run = 0.0;
  for (const StoredCell& cell : cells) {
    for (const Column& column : cell.usual()) of_run += static_cast<double>(column.bytes());
    for (const Column& column : cell.full()) of_full_run += static_cast<double>(column.bytes());
  }
  double of_sums = 0.0;
  if (sums) {
    for (const std::uint64_t words : sums->words) of_sums += 8.0 * static_cast<double>(words);
  }
  return of_sums + of_run * static_cast<double>(runs.size()) +
         of_full_run * static_cast<double>(full_runs_here());
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
  result.full_runs = std::min(plan.columns.full_runs, plan.runs);
  number_runs(plan, result);
  describe_time(itinerary, plan.columns.scans_only, result);
  if (plan.columns.joint) {
    result.joint_scans = joint_scans_of(itinerary.scans(), plan.columns.joint_scans);
  }
  result.start = itinerary.start;
  result.landmarks = itinerary.landmarks;
  result.waypoints = itinerary.waypoints;
  result.references = itinerary.references;
  for (std::size_t run = 0; run < plan.drives->own_drives(); ++run) {
    result.drives.push_back(own_drive(plan.drives->itinerary_of(run), plan.columns.scans_only));
  }
  result.has_truth = itinerary.has_truth;
  result.own_landmarks = plan.own_landmarks && !itinerary.landmarks.empty();
  result.scenario = plan.scenario;
  result.provenance = provenance;
  for (const Cell& cell : plan.cells) result.cells.push_back(describe(cell, plan));
  return result;
}

namespace {

bool same_column(const Column& a, const Column& b) {
  return a.name == b.name && a.element == b.element && a.shape == b.shape;
}

bool same_columns(const StoredCell& a, const StoredCell& b) {
  return a.label == b.label && a.usual_columns == b.usual_columns &&
         std::ranges::equal(a.columns, b.columns, same_column);
}

/// A fact about a build. Flags are returned without the instruction set, which does not change any
/// bit.
std::optional<std::string> fact(const TextPairs& build, const std::string& name) {
  const auto found = std::ranges::find(build, name, [](const auto& pair) { return pair.first; });
  if (found == build.end()) return std::nullopt;
  if (name != "flags") return found->second;
  std::istringstream words(found->second);
  std::string rest;
  for (std::string word; words >> word;) {
    if (!word.starts_with("-march=")) append_part(rest, word, " ");
  }
  return rest;
}

/// The text of a study without its number of runs.
std::string without_runs(const std::string& study) {
  std::istringstream lines(study);
  std::string rest;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("runs = ")) rest += line + "\n";
  }
  return rest;
}

}  // namespace

std::optional<std::string> difference(const ResultDescription& a, const ResultDescription& b,
                                      const std::filesystem::path& path) {
  if (a.study_sha256 != b.study_sha256 &&
      without_runs(a.study_text) == without_runs(b.study_text)) {
    const std::string most = std::to_string(std::max(a.study_runs, b.study_runs));
    return formatted(
        "{}: belongs to a study of another number of runs ({}, not {}): compute the parts of one "
        "study, all with --set study.runs={} and each with its --runs FIRST:LAST, or add runs to "
        "the result of fewer by 'montecarta run STUDY -o RESULT --set study.runs={} --resume'",
        path, b.study_runs, a.study_runs, most, most);
  }
  if (a.study_sha256 != b.study_sha256) {
    return formatted(
        "{}: belongs to another study ('{}', SHA-256 {}, not '{}', {}): give the files of one "
        "study, made with the same --set",
        path, b.study_name, b.study_sha256.substr(0, 12), a.study_name,
        a.study_sha256.substr(0, 12));
  }
  if (std::ranges::equal(a.cells, b.cells, same_columns) && a.full_runs == b.full_runs &&
      a.times == b.times && a.scan_steps == b.scan_steps && a.joint_scans == b.joint_scans)
    return std::nullopt;
  return path.string() +
         ": is laid out differently (another version of montecarta, or of a world file, made it): "
         "make it anew";
}

std::vector<std::string> build_differences(const TextPairs& a, const TextPairs& b) {
  std::vector<std::string> found;
  for (const char* name : {"version", "git", "compiler", "flags", "libm"}) {
    const std::optional<std::string> in_a = fact(a, name), in_b = fact(b, name);
    if (!in_a || !in_b || *in_a == *in_b) continue;
    found.push_back(formatted(
        "two builds worked on this study ({}: {} and {}): the last digits of their runs may differ",
        name, *in_a, *in_b));
  }
  return found;
}

}  // namespace montecarta::engine
