// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/read_description.hpp"

#include "engine/errors.hpp"
#include "engine/records/check_description.hpp"
#include "engine/records/result_format.hpp"
#include "engine/records/result_schema.hpp"

#include <algorithm>
#include <optional>
#include <string_view>

namespace montecarta::engine {
namespace {

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

std::uint64_t minor_version_of(const h5::Handle& file, const std::filesystem::path& path) {
  if (h5::find_text(file, "filetype") != std::string(format::kFiletype)) {
    throw StudyError(
        "{}: not a montecarta result (its attribute 'filetype' is not '{}'): give a file that "
        "'montecarta run' wrote",
        path, format::kFiletype);
  }
  const auto version = h5::numbers(file, "format_version");
  if (version.size() != 2 || version[0] != format::kMajor) {
    throw StudyError(
        "{}: format version {} (this program reads version {}): use the montecarta that wrote it",
        path, version.empty() ? "?" : std::to_string(version[0]), format::kMajor);
  }
  return version[1];
}

ResultDescription read_description(const h5::Handle& file, const std::filesystem::path& path) {
  minor_version_of(file, path);
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

}  // namespace montecarta::engine
