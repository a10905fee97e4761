// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/recordings/find_recording.hpp"

#include "engine/errors.hpp"
#include "engine/records/fingerprint.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <system_error>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

/// All numbers of a log, one behind the other, lengths before what has one.
class Bytes {
 public:
  /// Of a log with so many controls, and components of a detection.
  Bytes(std::size_t controls, std::size_t components)
      : controls_(controls), components_(components) {}
  template <class Number>
  void add(Number number) {
    text_.append(reinterpret_cast<const char*>(&number), sizeof number);
  }
  void add_name(const std::string& name) {
    add(std::uint64_t{name.size()});
    text_ += name;
  }
  void add(const Pose& pose) { add(pose.x), add(pose.y), add(pose.heading); }
  void add(const Eigen::Vector2d& point) { add(point.x()), add(point.y()); }
  void add(const Odometry& o) {
    add(o.time);
    for (std::size_t i = 0; i < controls_; ++i) add(o.control[i]);
  }
  void add(const Detection& d) {
    for (std::size_t i = 0; i < components_; ++i) add(d[i]);
    add(d.identity);
  }
  void add(const LoggedScan& scan) { add(scan.time), add(scan.detections); }
  void add(const ReferencePath& path) {
    add_name(path.name);
    add(path.time), add(path.position), add(path.heading);
    if (!path.covariance.empty()) add(path.covariance);  // drives without keep their fingerprint
  }
  void add(const Eigen::Matrix3d& matrix) {
    for (const double element : matrix.reshaped()) add(element);
  }
  template <class Item>
  void add(const std::vector<Item>& items) {
    add(std::uint64_t{items.size()});
    for (const Item& item : items) add(item);
  }
  const std::string& text() const { return text_; }

 private:
  std::size_t controls_, components_;
  std::string text_;
};

std::optional<fs::path> recording_at(const std::string& path, std::vector<fs::path> places) {
  places.emplace_back();
  if (const char* data = std::getenv("MONTECARTA_DATA")) {
    for (const std::string& folder : split(data, ':')) places.emplace_back(folder);
  }
  for (const fs::path& place : places) {
    std::error_code ignored;  // what cannot be looked at is not there
    if (fs::is_directory(place / path, ignored)) return place / path;
  }
  return std::nullopt;
}

/// Of the first name in a list: the longest one with commas that is a folder, else up to a comma.
std::size_t end_of_name(std::string_view list, const std::vector<fs::path>& folders) {
  const std::size_t first_comma = std::min(list.find(','), list.size());
  for (std::size_t end = list.size(); end > first_comma; end = list.rfind(',', end - 1)) {
    if (recording_at(std::string(trimmed(list.substr(0, end))), folders)) return end;
  }
  return first_comma;
}

}  // namespace

fs::path find_recording(const std::string& path, const std::vector<fs::path>& folders) {
  if (const auto folder = recording_at(path, folders)) return *folder;
  throw StudyError("no folder '" + path +
                   "' (looked beside the study, here, and in $MONTECARTA_DATA; recorded drives are "
                   "not part of montecarta): correct scenario.path, or set MONTECARTA_DATA to the "
                   "folder that holds it");
}

std::vector<std::string> recordings_in(const std::string& list,
                                       const std::vector<fs::path>& folders) {
  std::vector<std::string> names;
  std::string_view rest = list;
  for (std::size_t end = 0;; rest.remove_prefix(end + 1)) {
    end = end_of_name(rest, folders);
    names.emplace_back(trimmed(rest.substr(0, end)));
    if (end == rest.size()) return names;
  }
}

std::string fingerprint_of(const DriveLog& log) {
  Bytes bytes(log.controls.size(), log.components.size());
  bytes.add(log.start_time);
  bytes.add(log.start);
  if (log.controls.data() != controls_of(Car()).data()) {  // drives of cars keep theirs
    for (const Quantity control : log.controls) bytes.add_name(component_of(control).name);
  }
  if (log.components.data() != components_of(Sensor()).data()) {  // those of range and bearing too
    for (const Quantity quantity : log.components) bytes.add_name(component_of(quantity).name);
  }
  bytes.add(log.odometry);
  bytes.add(log.scans);
  bytes.add(log.references);
  bytes.add(log.landmarks);
  return sha256(bytes.text());
}

}  // namespace montecarta::experiments
