// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/result_description.hpp"

#include "engine/errors.hpp"
#include "engine/records/fingerprint.hpp"
#include "engine/records/result_layout.hpp"
#include "engine/records/run_record.hpp"
#include "engine/records/seal.hpp"
#include "engine/text/visible_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <optional>

namespace montecarta::engine {
namespace {

constexpr std::uint64_t kMostRuns = 10'000'000;  // limits the memory for the bookkeeping of a file

void number_runs(const StudyPlan& plan, ResultDescription& result) {
  if (plan.runs_here() > kMostRuns) {
    throw StudyError(plan.name + ": " + std::to_string(plan.runs_here()) +
                     " runs (one file holds at most " + std::to_string(kMostRuns) +
                     "): lower study.runs, or split the study with --shard I/N");
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

OwnDrive own_drive(const Itinerary& itinerary) {
  OwnDrive drive{itinerary.start, {}, itinerary.scan_step, itinerary.references};
  for (const std::uint32_t step : itinerary.scan_step)
    drive.scan_times.push_back(itinerary.step_time[step]);
  return drive;
}

bool has(std::span<const Column> columns, std::string_view name) {
  return std::ranges::find(columns, name, &Column::name) != columns.end();
}

}  // namespace

bool StoredCell::has(std::string_view column) const { return engine::has(usual(), column); }

const Column* StoredCell::find(std::string_view column) const {
  const auto found = std::ranges::find(columns, column, &Column::name);
  return found == columns.end() ? nullptr : &*found;
}

std::string StoredCell::dataset_of(std::size_t c) const {
  return "cells/" + label + "/" + (c < usual_columns ? "" : std::string(format::kFull) + "/") +
         columns[c].name;
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
    result.drives.push_back(own_drive(plan.drives->itinerary_of(run)));
  }
  result.has_truth = itinerary.has_truth;
  result.own_landmarks = plan.own_landmarks && !itinerary.landmarks.empty();
  result.scenario = plan.scenario;
  result.provenance = provenance;
  for (const Cell& cell : plan.cells) result.cells.push_back(describe(cell, plan));
  return result;
}

namespace {

void expect_result_file(const h5::Handle& file, const std::filesystem::path& path) {
  if (h5::find_text(file, "filetype") != std::string(format::kFiletype)) {
    throw StudyError(
        path.string() + ": not a montecarta result (its attribute 'filetype' is not '" +
        std::string(format::kFiletype) + "'): give a file that 'montecarta run' wrote");
  }
  const auto version = h5::numbers(file, "format_version");
  if (version.size() != 2 || version[0] != format::kMajor) {
    throw StudyError(path.string() + ": format version " +
                     (version.empty() ? "?" : std::to_string(version[0])) +
                     " (this program reads version " + std::to_string(format::kMajor) +
                     "): use the montecarta that wrote it");
  }
}

/// The axes behind `run_axis` in a text such as "run, time, component"; nullopt if the text is
/// different.
std::optional<std::vector<Axis>> axes_of(const std::string& dimension_order,
                                         std::string_view run_axis) {
  std::vector<Axis> axes;
  std::size_t begin = dimension_order.find(", ");
  if (dimension_order.substr(0, begin) != run_axis) return std::nullopt;
  while (begin != std::string::npos) {
    const std::size_t end = dimension_order.find(", ", begin + 2);
    const auto axis =
        axis_named(std::string_view(dimension_order).substr(begin + 2, end - begin - 2));
    if (!axis) return std::nullopt;
    axes.push_back(*axis);
    begin = end;
  }
  return axes;
}

/// A dataset as a column; nullopt if it is none, since later versions may have added other
/// datasets.
std::optional<Column> column_of(const h5::Handle& group, const std::string& name,
                                std::string_view run_axis, std::size_t runs) {
  if (std::ranges::count(format::kBesideColumns, name) > 0) return std::nullopt;
  const h5::Handle dataset = h5::open_dataset(group, name);
  const auto axes = axes_of(h5::find_text(dataset, "dimension_order").value_or(""), run_axis);
  const auto element = h5::element(dataset);
  const h5::Shape shape = h5::shape(dataset);
  if (!axes || !element || shape.size() != axes->size() + 1 || shape[0] != runs)
    return std::nullopt;
  return Column{name,
                *element,
                *axes,
                {shape.begin() + 1, shape.end()},
                h5::find_text(dataset, "units").value_or("1"),
                h5::find_text(dataset, "long_name").value_or(name)};
}

/// Appends all members of the group that are columns of `runs` runs.
void read_columns(const h5::Handle& group, std::string_view run_axis, std::size_t runs,
                  std::vector<Column>& columns) {
  for (const std::string& name : h5::members(group)) {
    if (h5::is_group(group, name)) continue;
    if (auto column = column_of(group, name, run_axis, runs)) columns.push_back(*std::move(column));
  }
}

StoredCell read_cell(const h5::Handle& cells, const std::string& label,
                     const ResultDescription& result) {
  const h5::Handle group = h5::open_group(cells, label);
  StoredCell cell;
  cell.label = label;
  cell.filter = h5::text(group, "filter");
  cell.long_name = h5::text(group, "long_name");
  cell.particles = h5::number(group, "particles");
  cell.settings = h5::texts(h5::open_group(group, "settings"));
  read_columns(group, "run", result.runs.size(), cell.columns);
  cell.usual_columns = cell.columns.size();
  if (h5::has(group, format::kFull)) {
    read_columns(h5::open_group(group, format::kFull), format::kFullRun, result.full_runs_here(),
                 cell.columns);
  }
  return cell;
}

std::optional<SummedRuns> read_summed_runs(const h5::Handle& file,
                                           const std::vector<StoredCell>& cells) {
  if (!h5::has(file, format::kSums)) return std::nullopt;
  const h5::Handle group = h5::open_group(file, format::kSums);
  SummedRuns sums{h5::number(group, "first_run"), h5::number(group, "last_run"), {}};
  for (const StoredCell& cell : cells) {
    const h5::Shape shape = h5::shape(h5::open_dataset(group, cell.label));
    sums.words.push_back(shape.size() == 1 ? shape.front() : 0);
  }
  return sums;
}

}  // namespace

ResultDescription read_description(const h5::Handle& file, const std::filesystem::path& path) {
  expect_result_file(file, path);
  ResultDescription result;
  read_schema(file, result);
  result.has_truth = h5::has(file, "truth");
  result.own_landmarks = result.has_truth && h5::has(h5::open_group(file, "truth"), "landmarks");
  const h5::Handle cells = h5::open_group(file, "cells");
  for (const std::string& label : h5::members(cells))
    result.cells.push_back(read_cell(cells, label, result));
  result.sums = read_summed_runs(file, result.cells);
  check_description(result, path);
  return result;
}

ResultDescription read_description(const std::filesystem::path& path) {
  check_seal(path);
  return read_description(h5::open_file(path), path);
}

namespace {

constexpr std::size_t kLongestLabel = 1000;
constexpr std::uint32_t kMostSteps = 1U << 27U;  // of a run; more would take days to process

bool are_finite(const std::vector<double>& values) {
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

bool are_finite(const std::vector<Eigen::Vector2d>& points) {
  return std::ranges::all_of(points, [](const Eigen::Vector2d& p) { return p.allFinite(); });
}

template <class T>
bool increases(const std::vector<T>& values) {
  return std::ranges::adjacent_find(values, std::ranges::greater_equal()) == values.end();
}

/// Throws StudyError with a description of the damage unless the condition holds.
using Check = std::function<void(bool, const std::string&)>;

/// Texts that are shown within one line of a table, a figure or a comment.
void check_texts(const ResultDescription& d, const Check& check) {
  const auto expect_line = [&](const std::string& text) {
    check(visible(text, "\t") == text, "a control character in '" + visible(text) + "'");
  };
  expect_line(d.study_name);
  expect_line(d.title);
  for (const auto& [key, value] : d.scenario) expect_line(key), expect_line(value);
  for (const StoredCell& cell : d.cells) {
    for (const std::string& text : {cell.label, cell.filter, cell.long_name}) expect_line(text);
    for (const auto& [key, value] : cell.settings) expect_line(key), expect_line(value);
    for (const Column& column : cell.columns) {
      for (const std::string& text : {column.name, column.units, column.long_name}) {
        expect_line(text);
      }
    }
  }
}

void check_runs(const ResultDescription& d, const Check& check) {
  check(!d.runs.empty() && increases(d.runs), "its run numbers do not increase");
  check(d.runs.back() < d.study_runs, "a run number is beyond the study's runs");
  check(d.full_runs <= d.study_runs, "more runs are full than the study has");
  if (!d.sums) return;
  const auto is_border = [&](std::uint64_t run) {
    return run % kRunsOfAGroup == 0 || run == d.study_runs;
  };
  check(d.sums->first_run < d.sums->last_run && d.sums->last_run <= d.study_runs &&
            is_border(d.sums->first_run) && is_border(d.sums->last_run),
        "its sums are of no groups of runs of the study");
  check(d.runs.front() == d.sums->first_run && d.runs.back() < d.sums->last_run,
        "its runs are not the first of which it has sums");
}

void check_times(const ResultDescription& d, const Check& check) {
  check(are_finite(d.times) && std::ranges::is_sorted(d.times),
        "its times do not increase, or are no numbers");
  const std::size_t scans = d.scan_times.size();
  check(d.scan_rows.size() == scans && d.scan_steps.size() == scans,
        "scan, scan_step and scan_row are not equally long");
  check(increases(d.scan_steps) && increases(d.scan_rows), "scan_step or scan_row do not increase");
  if (scans == 0) return;
  check(d.scan_rows.back() < d.times.size(), "scan_row is beyond the rows of time");
  check(d.scan_steps.back() < kMostSteps, "scan_step is beyond any drive");
  for (std::size_t s = 0; s < scans; ++s) {
    check(d.scan_times[s] == d.times[d.scan_rows[s]], "scan is not time at scan_row");
  }
  check(d.scan_rows == d.scan_steps || d.times.size() == scans,
        "scan_row is neither scan_step nor one row after the other");
  check(increases(d.joint_scans) && (d.joint_scans.empty() || d.joint_scans.back() < scans),
        "joint_scan does not increase, or is beyond the scans");
}

void check_references(const std::vector<ReferencePath>& references, const Check& check) {
  for (const ReferencePath& path : references) {
    check(path.position.size() == path.time.size() &&
              (path.heading.empty() || path.heading.size() == path.time.size()),
          "reference " + path.name + " has other fixes than times");
    check(are_finite(path.time) && are_finite(path.position),
          "a fix of reference " + path.name + " is no place");
    const auto is_finite = [](const Eigen::Matrix3d& covariance) { return covariance.allFinite(); };
    check((path.covariance.empty() || path.covariance.size() == path.time.size()) &&
              std::ranges::all_of(path.covariance, is_finite),
          "reference " + path.name + " has no covariance for each of its fixes");
  }
}

/// Returns whether two references have the same name and the same kinds of data.
bool are_alike(const ReferencePath& a, const ReferencePath& b) {
  return a.name == b.name && a.heading.empty() == b.heading.empty() &&
         a.covariance.empty() == b.covariance.empty();
}

void check_scenario(const ResultDescription& d, const Check& check) {
  check(are_finite({d.start.x, d.start.y, d.start.heading}) && are_finite(d.landmarks) &&
            are_finite(d.waypoints),
        "start, landmarks or waypoints are no places");
  check_references(d.references, check);
}

/// Checks the scans of runs that are drives of their own.
void check_drives(const ResultDescription& d, const Check& check) {
  if (d.drives.empty()) return;
  check(d.drives.size() == d.study_runs && d.times.size() == d.scan_times.size(),
        "it has not one drive for each run, with rows at scans");
  for (const OwnDrive& drive : d.drives) {
    check(!drive.scan_times.empty() && drive.scan_times.size() <= d.scan_times.size() &&
              drive.scan_times.size() == drive.scan_steps.size(),
          "a drive has no scans, or more than the file");
    check(are_finite(drive.scan_times) && increases(drive.scan_times) &&
              increases(drive.scan_steps) &&
              are_finite({drive.start.x, drive.start.y, drive.start.heading}),
          "the times or the start of a drive are no numbers, or do not increase");
    check_references(drive.references, check);
    check(std::ranges::equal(drive.references, d.drives.front().references, are_alike),
          "its drives have different references");
  }
}

std::vector<std::string_view> nees_columns() {
  std::vector<std::string_view> names;
  for (const StoredConvention& convention : kErrorConventions)
    names.emplace_back(convention.column);
  return names;
}

/// Columns that must be stored together.
const std::vector<std::vector<std::string_view>> kTogether = {
    {"pose_mean_mixture", "pose_covariance_mixture"},
    {"nis", "nis_dof"},
    {"particle_pose", "log_weight"},
    {"map_mean", "map_covariance", "map_seen"},
    {"final_map_mean", "final_map_covariance", "final_map_seen"},
    {"joint_mean", "joint_covariance"},
    {"error", "error_covariance"},
    nees_columns()};

void check_columns(const StoredCell& cell, const Check& check) {
  for (const Column& column : cell.columns) {
    const auto known = std::ranges::find(column_table(), column.name, &ColumnKind::name);
    check(known == column_table().end() || known->axes == column.axes,
          "cells/" + cell.label + "/" + column.name + " has other axes than it should");
  }
  for (const std::span<const Column> columns : {cell.usual(), cell.full()}) {
    for (const auto& together : kTogether) {
      const auto there = std::ranges::count_if(
          together, [&](std::string_view name) { return has(columns, name); });
      check(there == 0 || there == std::ssize(together),
            "cells/" + cell.label + " has only a part of " + std::string(together.front()) +
                " and what belongs to it");
    }
    check(has(columns, "pose_covariance") || cell.has("error") ||
              !has(columns, "pose_covariance_mixture"),
          "cells/" + cell.label + " has pose_covariance_mixture and no pose_covariance");
  }
  check(cell.has("pose_mean") || cell.has("error"), "cells/" + cell.label + " has no pose_mean");
  check(cell.label.size() <= kLongestLabel, "the label of a cell is too long");
}

/// The row axis of a covariance, which has the length of its column axis.
Axis row_axis(Axis axis) {
  if (axis == Axis::state_column) return Axis::state;
  return axis == Axis::error_component_column ? Axis::error_component : axis;
}

void check_lengths(const ResultDescription& d, const StoredCell& cell, const Check& check) {
  const AxisLengths lengths{.time = d.times.size(),
                            .scan = d.scan_times.size(),
                            .joint = d.joint_scans.size(),
                            .particle = cell.particles,
                            .landmark = std::nullopt,
                            .error_component = std::nullopt};
  std::map<Axis, std::size_t> own;
  for (const Column& column : cell.columns) {
    for (std::size_t a = 0; a < column.axes.size(); ++a) {
      const Axis axis = row_axis(column.axes[a]);
      const auto known =
          length_of(axis, lengths).value_or(own.try_emplace(axis, column.shape[a]).first->second);
      check(column.shape[a] == known, "cells/" + cell.label + "/" + column.name +
                                          " is not as long as its axis " +
                                          std::string(name_of(axis)));
    }
  }
}

}  // namespace

void check_description(const ResultDescription& description, const std::filesystem::path& path) {
  const Check check = [&](bool condition, const std::string& damage) {
    if (condition) return;
    throw StudyError(path.string() + ": damaged (" + damage +
                     "): take a copy that is whole, or run the study again");
  };
  check_texts(description, check);
  check_runs(description, check);
  check_times(description, check);
  check_scenario(description, check);
  check_drives(description, check);
  for (const StoredCell& cell : description.cells) {
    check_columns(cell, check);
    check_lengths(description, cell, check);
  }
}

}  // namespace montecarta::engine
