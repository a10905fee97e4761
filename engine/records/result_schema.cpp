// SPDX-License-Identifier: BSD-3-Clause
// The description in a result file, listed once for both the writer and the reader
// (analysis/FORMAT.md).
#include "engine/records/result_layout.hpp"
#include "engine/records/run_record.hpp"

#include <algorithm>
#include <array>
#include <functional>
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

/// The name of member i of a group. A reference has a name of its own, a drive that of its run.
std::string member_name(const ReferencePath& path, std::size_t /*i*/) { return path.name; }
std::string member_name(const OwnDrive& /*drive*/, std::size_t i) {
  constexpr std::size_t kDigits = 5;
  const std::string number = std::to_string(i);
  return "drive_" + std::string(kDigits - std::min(kDigits, number.size()), '0') + number;
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
    add_scale(object_, name, values, label, scales_);
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
    visit_references(one, drive.references);
  });
}

/// `between` is called before the last fields.
template <class Fields, class Description>
void visit(Fields& file, Description& d, const std::function<void()>& between) {
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

}  // namespace

void write_schema(const h5::Handle& file, const ResultDescription& description, Scales& scales,
                  const std::function<void()>& add_runs) {
  FieldWriter writer(file, scales);
  visit(writer, description, add_runs);
}

void read_schema(const h5::Handle& file, ResultDescription& description) {
  FieldReader reader(file);
  visit(reader, description, [] {});
  std::erase_if(description.provenance,
                [](const auto& pair) { return pair.first == "study_sha256"; });
}

}  // namespace montecarta::engine
