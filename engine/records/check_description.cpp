// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/check_description.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/run_record.hpp"
#include "engine/text/visible_text.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>

namespace montecarta::engine {
namespace {

constexpr std::size_t kLongestLabel = 1000;
// Largest number of steps of a run; more would take days to process.
constexpr std::uint32_t kMostSteps = 1U << 27U;

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

/// Checks the texts that are shown within one line of a table, a figure or a comment.
void check_texts(const ResultDescription& d, const Check& check) {
  const auto require_line = [&](const std::string& text) {
    check(visible(text, "\t") == text, formatted("a control character in '{}'", visible(text)));
  };
  require_line(d.study_name);
  require_line(d.title);
  for (const auto& [key, value] : d.scenario) require_line(key), require_line(value);
  for (const StoredCell& cell : d.cells) {
    for (const std::string& text : {cell.label, cell.filter, cell.long_name}) require_line(text);
    for (const auto& [key, value] : cell.settings) require_line(key), require_line(value);
    for (const Column& column : cell.columns) {
      for (const std::string& text : {column.name, column.units, column.long_name}) {
        require_line(text);
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
          formatted("reference {} has other fixes than times", path.name));
    check(are_finite(path.time) && are_finite(path.position),
          formatted("a fix of reference {} is no place", path.name));
    const auto is_finite = [](const Eigen::Matrix3d& covariance) { return covariance.allFinite(); };
    check((path.covariance.empty() || path.covariance.size() == path.time.size()) &&
              std::ranges::all_of(path.covariance, is_finite),
          formatted("reference {} has no covariance for each of its fixes", path.name));
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

/// Checks the rows of a run that is a drive of its own: its scans, or all of its steps.
void check_rows(const OwnDrive& drive, const ResultDescription& d, const Check& check) {
  constexpr const char* kWrong = "a drive has other rows than the file";
  if (drive.step_times.empty()) return check(d.times.size() == d.scan_times.size(), kWrong);
  check(drive.step_times.size() <= d.times.size() && are_finite(drive.step_times) &&
            std::ranges::is_sorted(drive.step_times) &&
            drive.scan_steps.back() < drive.step_times.size() && d.scan_rows == d.scan_steps,
        kWrong);
  for (std::size_t s = 0; s < drive.scan_times.size(); ++s) {
    check(drive.scan_times[s] == drive.step_times[drive.scan_steps[s]],
          "a scan of a drive is not at the time of its step");
  }
}

/// Checks the runs that are drives of their own.
void check_drives(const ResultDescription& d, const Check& check) {
  if (d.drives.empty()) return;
  check(d.drives.size() == d.study_runs, "it has not one drive for each run");
  for (const OwnDrive& drive : d.drives) {
    check(!drive.scan_times.empty() && drive.scan_times.size() <= d.scan_times.size() &&
              drive.scan_times.size() == drive.scan_steps.size(),
          "a drive has no scans, or more than the file");
    check(are_finite(drive.scan_times) && increases(drive.scan_times) &&
              increases(drive.scan_steps) &&
              are_finite({drive.start.x, drive.start.y, drive.start.heading}),
          "the times or the start of a drive are no numbers, or do not increase");
    check_rows(drive, d, check);
    check_references(drive.references, check);
    check(std::ranges::equal(drive.references, d.drives.front().references, are_alike),
          "its drives have different references");
  }
}

std::vector<std::string_view> nees_columns() {
  std::vector<std::string_view> names;
  for (std::size_t k = 0; k < kFirstConventions; ++k)
    names.emplace_back(kErrorConventions.at(k).column);
  return names;
}

bool has(std::span<const Column> columns, std::string_view name) {
  return std::ranges::find(columns, name, &Column::name) != columns.end();
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
          formatted("cells/{}/{} has other axes than it should", cell.label, column.name));
  }
  for (const std::span<const Column> columns : {cell.usual(), cell.full()}) {
    for (const auto& together : kTogether) {
      const auto there = std::ranges::count_if(
          together, [&](std::string_view name) { return has(columns, name); });
      check(there == 0 || there == std::ssize(together),
            formatted("cells/{} has only a part of {} and what belongs to it", cell.label,
                      together.front()));
    }
    check(has(columns, "pose_covariance") || cell.has("error") ||
              !has(columns, "pose_covariance_mixture"),
          formatted("cells/{} has pose_covariance_mixture and no pose_covariance", cell.label));
  }
  const std::pair<std::string, std::string> alone = {"state", "innovations"};
  const bool has_innovations_alone =
      cell.has("nis") && std::ranges::find(cell.settings, alone) != cell.settings.end();
  check(cell.has("pose_mean") || cell.has("error") || has_innovations_alone,
        formatted("cells/{} has no pose_mean", cell.label));
  check(cell.label.size() <= kLongestLabel, "the label of a cell is too long");
}

/// Returns the row axis of a covariance, which has the length of its column axis.
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
      check(column.shape[a] == known, formatted("cells/{}/{} is not as long as its axis {}",
                                                cell.label, column.name, name_of(axis)));
    }
  }
}

}  // namespace

void check_description(const ResultDescription& description, const std::filesystem::path& path) {
  const Check check = [&](bool condition, const std::string& damage) {
    if (condition) return;
    throw StudyError("{}: damaged ({}): take a copy that is whole, or run the study again", path,
                     damage);
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
