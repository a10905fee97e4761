// SPDX-License-Identifier: BSD-3-Clause
#include "engine/errors.hpp"
#include "engine/records/read_numbers.hpp"
#include "engine/records/result_layout.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <span>

namespace montecarta::engine {
namespace {

constexpr std::array kBookkeeping = {"status", "failure_reason", "failure_step", "fingerprint"};

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

/// The axes behind `run` out of "run, time, component"; nullopt where it is not of that kind.
std::optional<std::vector<Axis>> axes_of(const std::string& dimension_order) {
  std::vector<Axis> axes;
  std::size_t begin = dimension_order.find(", ");
  if (dimension_order.substr(0, begin) != "run") return std::nullopt;
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

/// A dataset as a column; nullopt where it is not one (a later version may have added other
/// things).
std::optional<Column> column_of(const h5::Handle& group, const std::string& name,
                                std::size_t runs) {
  if (std::ranges::find(kBookkeeping, name) != kBookkeeping.end()) return std::nullopt;
  const h5::Handle dataset = h5::open_dataset(group, name);
  const auto axes = axes_of(h5::find_text(dataset, "dimension_order").value_or(""));
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

StoredCell read_cell(const h5::Handle& cells, const std::string& label, std::size_t runs) {
  const h5::Handle group = h5::open_group(cells, label);
  StoredCell cell;
  cell.label = label;
  cell.filter = h5::text(group, "filter");
  cell.long_name = h5::text(group, "long_name");
  cell.particles = h5::number(group, "particles");
  cell.settings = h5::texts(h5::open_group(group, "settings"));
  for (const std::string& name : h5::members(group)) {
    if (h5::is_group(group, name)) continue;
    if (auto column = column_of(group, name, runs)) cell.columns.push_back(*std::move(column));
  }
  return cell;
}

void read_axes(const h5::Handle& file, ResultDescription& result) {
  result.runs = read_all<std::uint64_t>(file, "run", Element::u64);
  result.times = read_all<double>(file, "time", Element::f64);
  result.scan_times = read_all<double>(file, "scan", Element::f64);
  result.scan_steps = read_all<std::uint32_t>(file, "scan_step", Element::u32);
  result.scan_rows = read_all<std::uint32_t>(file, "scan_row", Element::u32);
  if (h5::has(file, "joint_scan")) {
    result.joint_scans = read_all<std::uint32_t>(file, "joint_scan", Element::u32);
  }
}

void read_scenario(const h5::Handle& file, ResultDescription& result) {
  const h5::Handle group = h5::open_group(file, "scenario");
  result.scenario = h5::texts(group);
  h5::read(h5::open_dataset(group, "start"), Element::f64,
           std::as_writable_bytes(std::span(&result.start, 1)));
  result.landmarks = read_points(group, "landmarks");
  result.waypoints = read_points(group, "waypoints");
  result.references = read_references(group);
  result.drives = read_own_drives(group);
}

void read_provenance(const h5::Handle& file, ResultDescription& result) {
  const h5::Handle group = h5::open_group(file, "provenance");
  result.provenance = h5::texts(group);
  std::erase_if(result.provenance, [](const auto& pair) { return pair.first == "study_sha256"; });
  result.study_sha256 = h5::text(group, "study_sha256");
  result.study_text = h5::read_text(h5::open_dataset(group, "study"));
}

}  // namespace

ResultDescription read_description(const h5::Handle& file, const std::filesystem::path& path) {
  expect_result_file(file, path);
  ResultDescription result;
  result.study_name = h5::text(file, "study");
  result.title = h5::text(file, "title");
  result.seed = h5::number(file, "seed");
  result.study_runs = h5::number(file, "runs");
  read_axes(file, result);
  read_scenario(file, result);
  result.has_truth = h5::has(file, "truth");
  result.own_landmarks = result.has_truth && h5::has(h5::open_group(file, "truth"), "landmarks");
  read_provenance(file, result);
  const h5::Handle cells = h5::open_group(file, "cells");
  for (const std::string& label : h5::members(cells))
    result.cells.push_back(read_cell(cells, label, result.runs.size()));
  check_description(result, path);
  return result;
}

}  // namespace montecarta::engine
