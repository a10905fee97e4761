// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/result_layout.hpp"

#include "engine/errors.hpp"
#include "engine/records/fingerprint.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <span>

namespace montecarta::engine {
namespace {

class SlabFinder {
 public:
  SlabFinder(const std::filesystem::path& path, const ResultDescription& description)
      : path_(path),
        file_(h5::open_file(path)),
        runs_(description.runs.size()),
        full_runs_(description.full_runs_here()) {}

  /// Finds a dataset with `run_bytes` for each run.
  Slab find(const std::string& name, std::uint64_t run_bytes) const {
    return find(name, run_bytes, runs_);
  }
  Slab find(const std::string& name, std::uint64_t run_bytes, std::size_t runs) const {
    const h5::Handle dataset = h5::open_dataset(file_, name);
    const auto place = h5::place(dataset);
    if (place && h5::stored_bytes(dataset) != runs * run_bytes) {
      throw StudyError(path_.string() + ": damaged ('" + name +
                       "' is not as long as its axes): run the study again");
    }
    if (!place) {
      throw StudyError(path_.string() + ": '" + name +
                       "' is not in one piece (another program rewrote the file): "
                       "use the file as montecarta wrote it");
    }
    return {*place, run_bytes, runs};
  }

  CellSlabs find(const StoredCell& cell) const {
    const std::string group = "cells/" + cell.label + "/";
    CellSlabs slabs;
    slabs.usual_columns = cell.usual_columns;
    for (std::size_t c = 0; c < cell.columns.size(); ++c) {
      slabs.columns.push_back(find(cell.dataset_of(c), cell.columns[c].bytes(),
                                   c < cell.usual_columns ? runs_ : full_runs_));
    }
    if (!cell.full().empty()) {
      slabs.full_fingerprint =
          find(group + format::kFull + "/fingerprint", sizeof(std::uint64_t), full_runs_);
    }
    slabs.failure_reason = find(group + "failure_reason", kFailureReasonBytes);
    slabs.failure_step = find(group + "failure_step", sizeof(std::uint32_t));
    slabs.fingerprint = find(group + "fingerprint", sizeof(std::uint64_t));
    slabs.cpu_seconds = find("timing/" + cell.label + "/cpu_seconds", sizeof(double));
    slabs.status = find(group + "status", 1);
    return slabs;
  }

 private:
  const std::filesystem::path& path_;
  h5::Handle file_;
  std::size_t runs_;
  std::size_t full_runs_;
};

void add_run(const PosixFile& file, const Slab& slab, std::size_t run_index,
             std::vector<std::byte>& buffer, Fingerprint& fingerprint) {
  if (buffer.size() < slab.run_bytes) buffer.resize(slab.run_bytes);
  const auto bytes = std::span(buffer).first(slab.run_bytes);
  file.read_at(slab.at(run_index), bytes);
  fingerprint.add(bytes);
}

std::uint64_t stored_fingerprint(const PosixFile& file, const Slab& slab, std::size_t run_index) {
  std::uint64_t stored = 0;
  file.read_at(slab.at(run_index), std::as_writable_bytes(std::span(&stored, 1)));
  return stored;
}

}  // namespace

ResultSlabs find_slabs(const std::filesystem::path& path, const ResultDescription& description) {
  const SlabFinder finder(path, description);
  ResultSlabs slabs;
  if (description.has_truth) {
    slabs.truth = {finder.find("truth/pose", description.times.size() * sizeof(Pose)),
                   finder.find("truth/fingerprint", sizeof(std::uint64_t)), std::nullopt};
    if (description.own_landmarks) {
      slabs.truth->landmarks =
          finder.find("truth/landmarks", description.landmarks.size() * sizeof(Eigen::Vector2d));
    }
  }
  slabs.wall_seconds = finder.find("timing/wall_seconds", sizeof(double), 1);
  slabs.sittings = finder.find("provenance/sittings", format::kSittingsBytes, 1);
  for (const StoredCell& cell : description.cells) slabs.cells.push_back(finder.find(cell));
  for (std::size_t c = 0; description.sums && c < description.cells.size(); ++c) {
    const SummedRuns& sums = *description.sums;
    const std::string& label = description.cells[c].label;
    slabs.sums.push_back(finder.find(std::string(format::kSums) + "/" + label,
                                     sums.words[c] * sizeof(std::uint64_t), 1));
    slabs.sum_seconds.push_back(finder.find("timing/" + label + "/" + format::kSumSeconds,
                                            sizeof(double), sums.last_run - sums.first_run));
  }
  return slabs;
}

std::vector<RunStatus> read_statuses(const PosixFile& file, const CellSlabs& cell,
                                     std::size_t runs) {
  std::vector<RunStatus> statuses(runs);
  file.read_at(cell.status.offset, std::as_writable_bytes(std::span(statuses)));
  expect_known(statuses, file.path().string());
  return statuses;
}

RunStatus status_of(const PosixFile& file, const CellSlabs& cell, std::size_t run_index) {
  RunStatus status{};
  file.read_at(cell.status.at(run_index), std::as_writable_bytes(std::span(&status, 1)));
  return status;
}

bool run_is_whole(const PosixFile& file, const CellSlabs& cell, std::size_t run_index,
                  std::vector<std::byte>& buffer) {
  const auto has = [&](const Slab& slab, std::uint64_t fingerprint) {
    return !slab.holds(run_index) || stored_fingerprint(file, slab, run_index) == fingerprint;
  };
  if (!is_stored(status_of(file, cell, run_index))) {
    return has(cell.fingerprint, 0) && has(cell.full_fingerprint, 0);
  }
  Fingerprint fingerprint, full;
  for (std::size_t c = 0; c < cell.columns.size(); ++c) {
    if (!cell.columns[c].holds(run_index)) continue;
    add_run(file, cell.columns[c], run_index, buffer, c < cell.usual_columns ? fingerprint : full);
  }
  for (const Slab& slab : {cell.status, cell.failure_step, cell.failure_reason})
    add_run(file, slab, run_index, buffer, fingerprint);
  return has(cell.fingerprint, fingerprint.value()) && has(cell.full_fingerprint, full.value());
}

bool truth_is_whole(const PosixFile& file, const ResultSlabs& slabs, std::size_t run_index,
                    std::vector<std::byte>& buffer) {
  if (!slabs.truth) return true;
  Fingerprint fingerprint;
  add_run(file, slabs.truth->pose, run_index, buffer, fingerprint);
  if (slabs.truth->landmarks) {
    add_run(file, *slabs.truth->landmarks, run_index, buffer, fingerprint);
  }
  return fingerprint.value() == stored_fingerprint(file, slabs.truth->fingerprint, run_index);
}

namespace {

void put_label(const h5::Handle& dataset, const Label& label) {
  h5::put_text(dataset, "units", label.units);
  h5::put_text(dataset, "long_name", label.long_name);
}

/// Attaches scales and stores the names of the axes, slowest first, for readers that reverse axes.
void put_dimensions(const h5::Handle& dataset, const std::vector<std::string>& dimensions,
                    const Scales& scales) {
  std::string order;
  for (unsigned axis = 0; axis < dimensions.size(); ++axis) {
    h5::attach_scale(dataset, scales.at(dimensions[axis]), axis);
    order += (axis == 0 ? "" : ", ") + dimensions[axis];
  }
  h5::put_text(dataset, "dimension_order", order);
}

void become_scale(h5::Handle dataset, const std::string& name, const Label& label, Scales& scales) {
  h5::make_scale(dataset, name);
  put_label(dataset, label);
  scales.insert_or_assign(name, std::move(dataset));
}

void add_numeric_scale(const h5::Handle& parent, const std::string& name, Element element,
                       std::size_t length, const void* values, const Label& label, Scales& scales) {
  h5::Handle dataset = h5::create_dataset(parent, name, element, {length});
  h5::write(dataset, element, values);
  become_scale(std::move(dataset), name, label, scales);
}

}  // namespace

h5::Handle add_dataset(const h5::Handle& parent, const std::string& name, Element element,
                       const h5::Shape& shape, const std::vector<std::string>& dimensions,
                       const Label& label, const Scales& scales) {
  h5::Handle dataset = h5::create_dataset(parent, name, element, shape);
  put_label(dataset, label);
  put_dimensions(dataset, dimensions, scales);
  return dataset;
}

h5::Handle add_text(const h5::Handle& parent, const std::string& name, const std::string& text,
                    std::size_t width, const Label& label) {
  h5::Handle dataset = h5::create_text(parent, name, width);
  h5::write_text(dataset, text);
  put_label(dataset, label);
  return dataset;
}

void add_scale(const h5::Handle& parent, const std::string& name, const std::vector<double>& values,
               const Label& label, Scales& scales) {
  add_numeric_scale(parent, name, Element::f64, values.size(), values.data(), label, scales);
}

void add_scale(const h5::Handle& parent, const std::string& name,
               const std::vector<std::uint64_t>& values, const Label& label, Scales& scales) {
  add_numeric_scale(parent, name, Element::u64, values.size(), values.data(), label, scales);
}

void add_index_scale(const h5::Handle& parent, const std::string& name, std::size_t length,
                     const Label& label, Scales& scales) {
  std::vector<std::uint32_t> values(length);
  std::iota(values.begin(), values.end(), 0U);
  add_numeric_scale(parent, name, Element::u32, length, values.data(), label, scales);
}

namespace {

/// Fills a dataset with zeros: a new dataset has undefined contents.
void write_zeros(const h5::Handle& dataset, Element element, std::size_t count) {
  const std::vector<std::byte> zeros(count * size_of(element));
  h5::write(dataset, element, zeros.data());
}

void add_truth(const h5::Handle& file, const ResultDescription& result, const Scales& scales) {
  const h5::Handle group = h5::create_group(file, "truth");
  add_dataset(group, "pose", Element::f64, {result.runs.size(), result.times.size(), 3},
              {"run", "time", "component"}, {"m, m, rad", "true pose"}, scales);
  if (result.own_landmarks) {
    add_dataset(group, "landmarks", Element::f64, {result.runs.size(), result.landmarks.size(), 2},
                {"run", "landmark", "coordinate"}, {"m", "true position of the landmark"}, scales);
  }
  const auto fingerprint =
      add_dataset(group, "fingerprint", Element::u64, {result.runs.size()}, {"run"},
                  {"1", "XXH3 of the run's pose, 0 where it is missing"}, scales);
  write_zeros(fingerprint, Element::u64, result.runs.size());
}

/// Adds a scale to the group of a cell, if cells differ in its length.
void add_own_scale(const h5::Handle& group, const StoredCell& cell, Axis axis,
                   const std::string& long_name, Scales& scales) {
  for (const Column& column : cell.columns) {
    const auto found = std::ranges::find(column.axes, axis);
    if (found == column.axes.end()) continue;
    const auto length = column.shape[static_cast<std::size_t>(found - column.axes.begin())];
    return add_index_scale(group, std::string(name_of(axis)), length, {"1", long_name}, scales);
  }
}

void add_bookkeeping(const h5::Handle& group, std::size_t runs, const Scales& scales) {
  const auto status = add_dataset(group, "status", Element::u8, {runs}, {"run"},
                                  {"1", "0 missing, 1 complete, 2 failed, 3 spared"}, scales);
  write_zeros(status, Element::u8, runs);
  add_dataset(group, "failure_reason", Element::u8, {runs, kFailureReasonBytes},
              {"run", "character"}, {"1", "why a failed run ended: UTF-8 text, zeros behind it"},
              scales);
  add_dataset(group, "failure_step", Element::u32, {runs}, {"run"},
              {"1", "control step at which a failed run ended"}, scales);
  const auto fingerprint = add_dataset(group, "fingerprint", Element::u64, {runs}, {"run"},
                                       {"1", "XXH3 of all that is stored of the run"}, scales);
  write_zeros(fingerprint, Element::u64, runs);
}

/// Adds a column of `runs` runs along `run_axis`.
void add_column(const h5::Handle& group, const Column& column, const char* run_axis,
                std::size_t runs, const Scales& scales) {
  h5::Shape shape = {runs};
  shape.insert(shape.end(), column.shape.begin(), column.shape.end());
  std::vector<std::string> dimensions = {run_axis};
  for (Axis axis : column.axes) dimensions.emplace_back(name_of(axis));
  add_dataset(group, column.name, column.element, shape, dimensions,
              {column.units, column.long_name}, scales);
}

/// Adds the columns that only the first runs have.
void add_full(const h5::Handle& group, const StoredCell& cell, std::size_t runs,
              const Scales& scales) {
  if (cell.full().empty()) return;
  const h5::Handle full = h5::create_group(group, format::kFull);
  const auto fingerprint =
      add_dataset(full, "fingerprint", Element::u64, {runs}, {format::kFullRun},
                  {"1", "XXH3 of what is stored of the run here"}, scales);
  write_zeros(fingerprint, Element::u64, runs);
  for (const Column& column : cell.full()) {
    add_column(full, column, format::kFullRun, runs, scales);
  }
}

void add_cell(const h5::Handle& cells, const StoredCell& cell, const ResultDescription& result,
              Scales& scales) {
  const std::size_t runs = result.runs.size();
  const h5::Handle group = h5::create_group(cells, cell.label);
  h5::put_text(group, "filter", cell.filter);
  h5::put_text(group, "long_name", cell.long_name);
  h5::put_numbers(group, "particles", std::array{std::uint64_t{cell.particles}});
  const h5::Handle settings = h5::create_group(group, "settings");
  for (const auto& [name, value] : cell.settings) h5::put_text(settings, name, value);
  add_own_scale(group, cell, Axis::particle, "index of the particle", scales);
  add_own_scale(group, cell, Axis::landmark, "landmark: its identity, or order of initialisation",
                scales);
  for (const Axis axis : {Axis::state, Axis::state_column}) {
    add_own_scale(group, cell, axis, "0 x, 1 y, 2 heading, then x and y of each landmark", scales);
  }
  for (const Axis axis : {Axis::error_component, Axis::error_component_column}) {
    add_own_scale(group, cell, axis, "component, in the order of the setting components", scales);
  }
  add_bookkeeping(group, runs, scales);
  for (const Column& column : cell.usual()) add_column(group, column, "run", runs, scales);
  add_full(group, cell, result.full_runs_here(), scales);
}

void add_sums(const h5::Handle& file, const ResultDescription& result) {
  const SummedRuns& sums = *result.sums;
  const h5::Handle group = h5::create_group(file, format::kSums);
  h5::put_numbers(group, "first_run", std::array{sums.first_run});
  h5::put_numbers(group, "last_run", std::array{sums.last_run});
  const auto add = [](const h5::Handle& parent, const std::string& name, Element element,
                      std::uint64_t length, const char* axis, const Label& label) {
    const h5::Handle dataset = h5::create_dataset(parent, name, element, {length});
    put_label(dataset, label);
    h5::put_text(dataset, "dimension_order", axis);
  };
  for (std::size_t c = 0; c < result.cells.size(); ++c) {
    const std::string& label = result.cells[c].label;
    add(group, label, Element::u64, sums.words[c], "word",
        {"1", "sums over groups of runs, to be read by montecarta"});
    add(h5::open_group(file, "timing/" + label), format::kSumSeconds, Element::f64,
        sums.last_run - sums.first_run, "summed_run",
        {"s", "processor time of the thread of every run in sums over its steps"});
  }
}

void add_timing(const h5::Handle& file, const ResultDescription& result, const Scales& scales) {
  const h5::Handle group = h5::create_group(file, "timing");
  const double none = 0.0;
  const auto wall = add_dataset(group, "wall_seconds", Element::f64, {}, {},
                                {"s", "wall time of all sittings"}, scales);
  h5::write(wall, Element::f64, &none);
  const std::vector<double> unknown(result.runs.size(), std::numeric_limits<double>::quiet_NaN());
  for (const StoredCell& cell : result.cells) {
    const h5::Handle of_cell = h5::create_group(group, cell.label);
    const auto cpu =
        add_dataset(of_cell, "cpu_seconds", Element::f64, {unknown.size()}, {"run"},
                    {"s", "processor time of the run's own thread over its steps"}, scales);
    h5::write(cpu, Element::f64, unknown.data());
  }
}

}  // namespace

void lay_out(const std::filesystem::path& path, const ResultDescription& result) {
  h5::Handle file = h5::create_file(path);
  Scales scales;
  h5::put_text(file, "filetype", std::string(format::kFiletype));
  h5::put_numbers(file, "format_version", std::array{format::kMajor, format::kMinor});
  write_schema(file, result, scales, [&] {
    if (result.has_truth) add_truth(file, result, scales);
    const h5::Handle cells = h5::create_group(file, "cells");
    for (const StoredCell& cell : result.cells) add_cell(cells, cell, result, scales);
    add_timing(file, result, scales);
    if (result.sums) add_sums(file, result);
  });
  add_text(
      h5::open_group(file, "provenance"), "sittings", "", format::kSittingsBytes,
      {"1", "one line for each resumption of the work: what was different from its beginning"});
  scales.clear();
  h5::close_file(std::move(file));
}

}  // namespace montecarta::engine
