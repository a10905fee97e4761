// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/result_schema.hpp"

#include "engine/formatted.hpp"
#include "engine/records/result_format.hpp"
#include "engine/records/run_record.hpp"
#include "engine/records/structure.hpp"
#include "engine/text/list_text.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <span>
#include <type_traits>
#include <utility>

namespace montecarta::engine {
namespace {

using Points = std::vector<Eigen::Vector2d>;
static_assert(sizeof(Pose) == 3 * sizeof(double));
static_assert(sizeof(Eigen::Vector2d) == 2 * sizeof(double));

template <class T>
constexpr Element element_of() {
  if (std::is_same_v<T, double>) return Element::f64;
  return std::is_same_v<T, std::uint64_t> ? Element::u64 : Element::u32;
}

/// Attributes that describe a dataset to readers.
struct Label {
  std::string units;
  std::string long_name;
};

/// {name of the dimension} dimension scales.
using Scales = std::map<std::string, h5::Handle, std::less<>>;

void put_label(const h5::Handle& dataset, const Label& label) {
  h5::put_text(dataset, "units", label.units);
  h5::put_text(dataset, "long_name", label.long_name);
}

/// Attaches scales and stores the names of the axes, slowest first, for readers that reverse axes.
void put_dimensions(const h5::Handle& dataset, const std::vector<std::string>& dimensions,
                    const Scales& scales) {
  for (unsigned axis = 0; axis < dimensions.size(); ++axis) {
    h5::attach_scale(dataset, scales.at(dimensions[axis]), axis);
  }
  h5::put_text(dataset, "dimension_order", joined(dimensions));
}

/// Adds a dataset with its label. The scales of its dimensions must exist.
h5::Handle add_dataset(const h5::Handle& parent, const std::string& name, Element element,
                       const h5::Shape& shape, const std::vector<std::string>& dimensions,
                       const Label& label, const Scales& scales) {
  h5::Handle dataset = h5::create_dataset(parent, name, element, shape);
  put_label(dataset, label);
  put_dimensions(dataset, dimensions, scales);
  return dataset;
}

/// Adds a text, padded with zeros to `width` bytes.
h5::Handle add_text(const h5::Handle& parent, const std::string& name, const std::string& text,
                    std::size_t width, const Label& label) {
  h5::Handle dataset = h5::create_text(parent, name, width);
  h5::write_text(dataset, text);
  put_label(dataset, label);
  return dataset;
}

/// Creates the scale of dimension `name`, and replaces any other of that name in `scales`.
void add_scale(const h5::Handle& parent, const std::string& name, Element element,
               std::size_t length, const void* values, const Label& label, Scales& scales) {
  h5::Handle dataset = h5::create_dataset(parent, name, element, {length});
  h5::write(dataset, element, values);
  h5::make_scale(dataset, name);
  put_label(dataset, label);
  scales.insert_or_assign(name, std::move(dataset));
}

/// Creates a scale with the numbers 0, 1, ..., length - 1.
void add_index_scale(const h5::Handle& parent, const std::string& name, std::size_t length,
                     const Label& label, Scales& scales) {
  std::vector<std::uint32_t> values(length);
  std::iota(values.begin(), values.end(), 0U);
  add_scale(parent, name, Element::u32, length, values.data(), label, scales);
}

/// The name of member i of a group. A reference has a name of its own, a drive that of its run.
std::string member_name(const ReferencePath& path, std::size_t /*i*/) { return path.name; }
std::string member_name(const OwnDrive& /*drive*/, std::size_t i) {
  constexpr std::size_t kDigits = 5;
  const std::string number = std::to_string(i);
  return formatted("drive_{}{}", std::string(kDigits - std::min(kDigits, number.size()), '0'),
                   number);
}
void take_name(const std::string& name, ReferencePath& path) { path.name = name; }
void take_name(const std::string& /*name*/, OwnDrive& /*drive*/) {}

/// Writes the fields of one HDF5 object.
class FieldWriter {
 public:
  FieldWriter(const h5::Handle& object, Scales& scales) : object_(object), scales_(scales) {}

  void text(const char* name, const std::string& value) { h5::put_text(object_, name, value); }
  void number(const char* name, std::uint64_t value) {
    h5::put_numbers(object_, name, std::array{value});
  }
  /// Writes the scale of full runs, unless no run is stored in full.
  void full_runs(const ResultDescription& d) {
    if (d.full_runs == 0) return;
    number(format::kFullRuns, d.full_runs);
    const auto end = d.runs.begin() + static_cast<std::ptrdiff_t>(d.full_runs_here());
    scale(format::kFullRun, std::vector(d.runs.begin(), end),
          {"1", "number of the run that is stored in full"});
  }
  void texts(const TextPairs& pairs) {
    for (const auto& [name, value] : pairs) h5::put_text(object_, name, value);
  }
  void document(const char* name, const std::string& content, const char* meaning) {
    add_text(object_, name, content, content.size(), {"1", meaning});
  }
  void counting_scale(const char* name, std::size_t length, const char* meaning) {
    add_index_scale(object_, name, length, {"1", meaning}, scales_);
  }
  template <class T>
  void scale(const char* name, const std::vector<T>& values, const Label& label) {
    add_scale(object_, name, element_of<T>(), values.size(), values.data(), label, scales_);
  }
  template <class T>
  void scale_if_any(const char* name, const std::vector<T>& values, const Label& label) {
    if (!values.empty()) scale(name, values, label);
  }
  template <class T>
  void along(const char* name, const char* dimension, const std::vector<T>& values,
             const Label& label) {
    write(name, element_of<T>(), {values.size()}, {dimension}, label, values.data());
  }
  template <class T>
  void along_if_any(const char* name, const char* dimension, const std::vector<T>& values,
                    const Label& label) {
    if (!values.empty()) along(name, dimension, values, label);
  }
  void pose(const char* name, const Pose& pose, const char* meaning) {
    write(name, Element::f64, {3}, {"component"}, {"m, m, rad", meaning}, &pose);
  }
  /// Writes points with their scale: e.g. "landmark" and "landmarks".
  void points(const std::string& one, const Points& points, const char* meaning) {
    if (points.empty()) return;
    counting_scale(one.c_str(), points.size(), ("identity of the " + one).c_str());
    positions((one + "s").c_str(), one.c_str(), points, meaning);
  }
  void positions(const char* name, const char* dimension, const Points& positions,
                 const char* meaning) {
    write(name, Element::f64, {positions.size(), 2}, {dimension, "coordinate"}, {"m", meaning},
          positions.data());
  }
  /// Writes the covariance of the measured components of every fix.
  void covariances(const ReferencePath& path) {
    if (path.covariance.empty()) return;
    const int d = path.dimension();
    const std::string axis = d == 3 ? "component" : "coordinate";
    std::vector<double> numbers;
    for (const Eigen::Matrix3d& covariance : path.covariance) {
      for (int i = 0; i < d; ++i) {
        for (int j = 0; j < d; ++j) numbers.push_back(covariance(i, j));
      }
    }
    const auto side = static_cast<std::uint64_t>(d);
    write("covariance", Element::f64, {path.covariance.size(), side, side},
          {"fix", axis, axis + "_column"},
          {d == 3 ? "(m, m, rad)^2" : "m2", "covariance of the error of the fix"}, numbers.data());
  }
  template <class Visit>
  void group(const char* name, const Visit& visit) {
    FieldWriter inside(h5::create_group(object_, name), scales_);
    visit(inside);
  }
  template <class Member, class Visit>
  void groups_if_any(const char* name, const std::vector<Member>& members, const Visit& visit) {
    if (members.empty()) return;
    group(name, [&](FieldWriter& all) {
      for (std::size_t i = 0; i < members.size(); ++i) {
        all.group(member_name(members[i], i).c_str(),
                  [&](FieldWriter& one) { visit(one, members[i]); });
      }
    });
  }

 private:
  FieldWriter(h5::Handle&& object, Scales& scales)
      : owned_(std::move(object)), object_(owned_), scales_(scales) {}
  void write(const char* name, Element element, const h5::Shape& shape,
             const std::vector<std::string>& dimensions, const Label& label, const void* values) {
    h5::write(add_dataset(object_, name, element, shape, dimensions, label, scales_), element,
              values);
  }

  h5::Handle owned_{-1};
  const h5::Handle& object_;
  Scales& scales_;
};

/// Reads the fields of one HDF5 object. Its members are those of FieldWriter.
class FieldReader {
 public:
  explicit FieldReader(const h5::Handle& object) : object_(object) {}

  void text(const char* name, std::string& value) { value = h5::text(object_, name); }
  void number(const char* name, std::uint64_t& value) { value = h5::number(object_, name); }
  void full_runs(ResultDescription& d) {
    if (h5::has(object_, format::kFullRun)) number(format::kFullRuns, d.full_runs);
  }
  void texts(TextPairs& pairs) { pairs = h5::texts(object_); }
  void document(const char* name, std::string& content, const char* /*meaning*/) {
    content = h5::read_text(h5::open_dataset(object_, name));
  }
  void counting_scale(const char*, std::size_t, const char*) {}
  template <class T>
  void scale(const char* name, std::vector<T>& values, const Label& /*label*/) {
    values = read_all<T>(name);
  }
  template <class T>
  void scale_if_any(const char* name, std::vector<T>& values, const Label& label) {
    if (h5::has(object_, name)) scale(name, values, label);
  }
  template <class T>
  void along(const char* name, const char* /*dimension*/, std::vector<T>& values, const Label&) {
    values = read_all<T>(name);
  }
  template <class T>
  void along_if_any(const char* name, const char* dimension, std::vector<T>& values,
                    const Label& label) {
    if (h5::has(object_, name)) along(name, dimension, values, label);
  }
  void pose(const char* name, Pose& pose, const char* /*meaning*/) {
    h5::read(h5::open_dataset(object_, name), Element::f64,
             std::as_writable_bytes(std::span(&pose, 1)));
  }
  void points(const std::string& one, Points& points, const char* meaning) {
    positions((one + "s").c_str(), one.c_str(), points, meaning);
  }
  void positions(const char* name, const char* /*dimension*/, Points& positions,
                 const char* /*meaning*/) {
    if (!h5::has(object_, name)) return;
    const auto flat = read_all<double>(name);
    for (std::size_t i = 0; i + 1 < flat.size(); i += 2)
      positions.emplace_back(flat[i], flat[i + 1]);
  }
  /// Reads one covariance for each complete block of numbers.
  void covariances(ReferencePath& path) {
    if (!h5::has(object_, "covariance")) return;
    const int d = path.dimension();
    const auto block = static_cast<std::size_t>(d) * static_cast<std::size_t>(d);
    const auto numbers = read_all<double>("covariance");
    for (std::size_t first = 0; first + block <= numbers.size(); first += block) {
      path.covariance.emplace_back(Eigen::Matrix3d::Zero());
      path.covariance.back().topLeftCorner(d, d) =
          Eigen::Map<const Eigen::MatrixXd>(numbers.data() + first, d, d);
    }
  }
  template <class Visit>
  void group(const char* name, const Visit& visit) {
    const h5::Handle inside = h5::open_group(object_, name);
    FieldReader reader(inside);
    visit(reader);
  }
  template <class Member, class Visit>
  void groups_if_any(const char* name, std::vector<Member>& members, const Visit& visit) {
    if (!h5::has(object_, name)) return;
    const h5::Handle all = h5::open_group(object_, name);
    for (const std::string& name_there : h5::members(all)) {
      const std::size_t i = members.size();
      take_name(name_there, members.emplace_back());
      FieldReader(all).group(member_name(members[i], i).c_str(),
                             [&](FieldReader& one) { visit(one, members[i]); });
    }
  }

 private:
  /// All numbers of a dataset as one vector.
  template <class T>
  std::vector<T> read_all(const std::string& name) {
    const h5::Handle dataset = h5::open_dataset(object_, name);
    const h5::Shape shape = h5::shape(dataset);
    std::vector<T> values(std::accumulate(shape.begin(), shape.end(), 1ULL, std::multiplies<>()));
    h5::read(dataset, element_of<T>(), std::as_writable_bytes(std::span(values)));
    return values;
  }

  const h5::Handle& object_;
};

template <class Fields, class References>
void visit_references(Fields& fields, References& references) {
  fields.groups_if_any("references", references, [](auto& one, auto& path) {
    one.scale("fix", path.time, {"s", "time of the fix"});
    one.positions("position", "fix", path.position, "measured position of the vehicle");
    one.along_if_any("heading", "fix", path.heading, {"rad", "measured heading of the vehicle"});
    one.covariances(path);
  });
}

template <class Fields, class Description>
void visit_axes(Fields& file, Description& d) {
  constexpr const char* kComponents = "component of a pose: 0 x, 1 y, 2 heading";
  constexpr const char* kCoordinates = "coordinate of a point: 0 x, 1 y";
  file.scale("run", d.runs, {"1", "number of the run in the study"});
  file.scale("time", d.times, {"s", "time of the estimate"});
  file.scale("scan", d.scan_times, {"s", "time of the scan"});
  file.counting_scale("component", 3, kComponents);
  file.counting_scale("component_column", 3, kComponents);
  file.counting_scale("coordinate", 2, kCoordinates);
  file.counting_scale("coordinate_column", 2, kCoordinates);
  file.counting_scale("character", kFailureReasonBytes, "place in a text");
  file.along("scan_step", "scan", d.scan_steps,
             {"1", "control step after which the scan is taken"});
  file.along("scan_row", "scan", d.scan_rows, {"1", "row of time at which the scan is taken"});
  std::vector<double> joint_times;
  for (const std::uint32_t scan : d.joint_scans) joint_times.push_back(d.scan_times[scan]);
  file.scale_if_any("joint", joint_times, {"s", "time of the joint estimate"});
  file.along_if_any("joint_scan", "joint", d.joint_scans, {"1", "scan of the joint estimate"});
}

template <class Fields, class Description>
void visit_scenario(Fields& scenario, Description& d) {
  constexpr const char* kStart = "pose before the first step";
  scenario.texts(d.scenario);
  scenario.pose("start", d.start, kStart);
  scenario.points("landmark", d.landmarks, "true position of the landmark");
  scenario.points("waypoint", d.waypoints, "position of the way-point");
  visit_references(scenario, d.references);
  scenario.groups_if_any("drives", d.drives, [](auto& one, auto& drive) {
    one.pose("start", drive.start, kStart);
    one.scale("scan_time", drive.scan_times, {"s", "time of the scan"});
    one.along("scan_step", "scan_time", drive.scan_steps,
              {"1", "control step after which the scan is taken"});
    one.scale_if_any("step_time", drive.step_times, {"s", "time at the end of the control step"});
    visit_references(one, drive.references);
  });
}

/// Calls all fields of the description; `between` is called before the last ones.
template <class Fields, class Description, class Between>
void visit(Fields& file, Description& d, const Between& between) {
  file.text("title", d.title);
  file.text("study", d.study_name);
  file.number("seed", d.seed);
  file.number("runs", d.study_runs);
  visit_axes(file, d);
  file.full_runs(d);
  file.group("scenario", [&](auto& scenario) { visit_scenario(scenario, d); });
  between();
  file.group("provenance", [&](auto& provenance) {
    provenance.texts(d.provenance);
    provenance.text("study_sha256", d.study_sha256);
    provenance.document("study", d.study_text, "study file with everything filled in");
  });
}

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
                                  {"1", "0 missing, 1 complete, 2 failed, 3 not needed"}, scales);
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
  FieldWriter writer(file, scales);
  visit(writer, result, [&] {
    if (result.has_truth) add_truth(file, result, scales);
    const h5::Handle cells = h5::create_group(file, "cells");
    for (const StoredCell& cell : result.cells) add_cell(cells, cell, result, scales);
    add_timing(file, result, scales);
    if (result.sums) add_sums(file, result);
  });
  add_text(
      h5::open_group(file, "provenance"), "sittings", "", format::kSessionsBytes,
      {"1", "one line for each resumption of the work: what was different from its beginning"});
  scales.clear();
  put_structure(file);
  h5::close_file(std::move(file));
}

void read_schema(const h5::Handle& file, ResultDescription& description) {
  FieldReader reader(file);
  visit(reader, description, [] {});
  std::erase_if(description.provenance,
                [](const auto& pair) { return pair.first == "study_sha256"; });
}

}  // namespace montecarta::engine
