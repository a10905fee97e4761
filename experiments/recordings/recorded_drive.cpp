// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/recordings/recorded_drive.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/fingerprint.hpp"
#include "engine/text/list_text.hpp"
#include "experiments/recordings/log_csv.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <optional>
#include <system_error>
#include <utility>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

/// The bytes of the numbers of a log, one behind the other. Lists and names are preceded by their
/// length.
class Bytes {
 public:
  /// Begins the bytes of a log that has this many controls, and this many components of a
  /// detection.
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
    // Without covariances nothing is added, so that the fingerprints of such drives stay the same.
    if (!path.covariance.empty()) add(path.covariance);
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
    std::error_code ignored;  // a folder that cannot be accessed counts as missing
    if (fs::is_directory(place / path, ignored)) return place / path;
  }
  return std::nullopt;
}

/// End of the first name in a list: the longest text up to a comma that is an existing folder, or
/// else the text up to the first comma.
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
  throw StudyError(
      "no folder '{}' (looked beside the study, here, and in $MONTECARTA_DATA; recorded drives are "
      "not part of montecarta): correct scenario.path, or set MONTECARTA_DATA to the folder that "
      "holds it",
      path);
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
  // For cars, and for sensors of range and bearing, no names are added, so that the fingerprints of
  // such drives stay the same.
  if (log.controls.data() != controls_of(Car()).data()) {
    for (const Quantity control : log.controls) bytes.add_name(component_of(control).name);
  }
  if (log.components.data() != components_of(Sensor()).data()) {
    for (const Quantity quantity : log.components) bytes.add_name(component_of(quantity).name);
  }
  bytes.add(log.odometry);
  bytes.add(log.scans);
  bytes.add(log.references);
  bytes.add(log.landmarks);
  return sha256(bytes.text());
}

namespace {

/// Describes all references: "gps with headings, without errors of its own; ...".
std::string references_in_words(const Itinerary& itinerary) {
  std::vector<std::string> all;
  for (const ReferencePath& path : itinerary.references) {
    all.push_back(formatted("{}{} headings, {} errors of its own", path.name,
                            path.heading.empty() ? " without" : " with",
                            path.covariance.empty() ? "without" : "with"));
  }
  return all.empty() ? "none" : joined(all, "; ");
}

void require_alike(const Itinerary& first, const Itinerary& other, std::size_t number) {
  const std::string drive = "drive " + std::to_string(number + 1);
  if (references_in_words(first) != references_in_words(other)) {
    throw StudyError(
        "{} has the references: {} (the first one has {}, and one verdict is by one reference): "
        "give all drives files of the same names and columns, or name one by scenario.reference",
        drive, references_in_words(other), references_in_words(first));
  }
  if (first.landmarks == other.landmarks) return;
  throw StudyError(drive +
                   " has other surveyed landmarks than the first one (drives of one scenario have "
                   "one map): give all the same landmarks.csv, or none");
}

/// Makes the rows of the odometry. A control holds from its time to that of the next one; the last
/// record ends the last step.
std::vector<Odometry> odometry_rows(const Itinerary& itinerary, const Drive& drive) {
  std::vector<Odometry> odometry;
  double begin = 0.0;
  for (std::size_t k = 0; k < itinerary.steps(); ++k) {
    odometry.push_back({begin, drive.controls[k]});
    begin = itinerary.step_time[k];
  }
  odometry.push_back({begin, {}});
  return odometry;
}

/// The longest time [s] for which a row of odometry moves the vehicle, until the next row.
double longest_hold(const DriveLog& log) {
  double longest = 0.0;
  for (std::size_t i = 1; i < log.odometry.size(); ++i) {
    const Odometry& held = log.odometry[i - 1];
    if (held.control.stands(moving_controls(log.controls))) continue;
    longest = std::max(longest, log.odometry[i].time - std::max(held.time, log.start_time));
  }
  return longest;
}

LoggedScan scan_of(double time, Scan scan, Identities identities) {
  LoggedScan logged{time, {scan.begin(), scan.end()}};
  if (identities == Identities::told) return logged;
  for (Detection& detection : logged.detections) detection.identity = Detection::kUnidentified;
  return logged;
}

ReferencePath truth_path(const Itinerary& itinerary, const Drive& drive) {
  ReferencePath path{
      .name = kLeadingReference, .time = itinerary.step_time, .position = {}, .heading = {}};
  for (const Pose& pose : drive.truth) {
    path.position.emplace_back(pose.x, pose.y);
    path.heading.push_back(pose.heading);
  }
  return path;
}

}  // namespace

RecordedDrive::RecordedDrive(const DriveLog& log, const LogReach& reach, double scan_delay) {
  itinerary_.start = {log.start.x, log.start.y, wrap(log.start.heading)};
  itinerary_.has_truth = false;
  itinerary_.moving_controls = moving_controls(log.controls);
  itinerary_.longest_hold = longest_hold(log);
  itinerary_.landmarks = log.landmarks;
  itinerary_.references = log.references;
  for (ReferencePath& path : itinerary_.references) {
    for (double& time : path.time) time -= log.start_time;
  }
  merge(log, reach, scan_delay);
}

void RecordedDrive::merge(const DriveLog& log, const LogReach& reach, double scan_delay) {
  drive_.scan_begin.assign(1, 0);
  Control control;  // the vehicle stands still before the first odometry
  auto odometry = log.odometry.begin();
  const auto drive_until = [&](double time) {
    for (; odometry != log.odometry.end() && odometry->time < time; ++odometry) {
      end_step(odometry->time - log.start_time, control);
      control = odometry->control;
    }
  };
  for (const LoggedScan& scan : log.scans) {
    const double time = scan.time - scan_delay;
    drive_until(time);
    end_step(time - log.start_time, control);
    take_scan(scan, log.components, reach);
  }
  drive_until(std::numeric_limits<double>::infinity());
}

/// Ends a step at `time` and ignores steps without duration. Odometry from before the start matters
/// only if it still holds at the start.
void RecordedDrive::end_step(double time, const Control& control) {
  const double before = itinerary_.step_time.empty() ? 0.0 : itinerary_.step_time.back();
  if (time <= before) return;
  itinerary_.step_time.push_back(time);
  drive_.controls.push_back(control);
}

void RecordedDrive::take_scan(const LoggedScan& scan, std::span<const Quantity> components,
                              const LogReach& reach) {
  if (itinerary_.step_time.empty()) {  // the vehicle is at the start
    itinerary_.step_time.push_back(0.0);
    drive_.controls.emplace_back();
  }
  itinerary_.scan_step.push_back(static_cast<std::uint32_t>(itinerary_.steps() - 1));
  std::ranges::copy_if(
      scan.detections, std::back_inserter(drive_.detections), [&](const Detection& d) {
        const double distance = distance_in(components, d).value_or(reach.max_range);
        return distance <= reach.max_range && distance >= reach.min_range;
      });
  drive_.scan_begin.push_back(static_cast<std::uint32_t>(drive_.detections.size()));
}

void RecordedDrive::generate(std::uint64_t /*run*/, Drive& drive) const { drive = drive_; }

SeveralDrives::SeveralDrives(std::vector<RecordedDrive> drives) : drives_(std::move(drives)) {
  expect(!drives_.empty(), "several drives are at least one");
  const auto scans = [](const RecordedDrive& drive) { return drive.itinerary().scans(); };
  itinerary_ = std::ranges::max_element(drives_, {}, scans)->itinerary();
  itinerary_.references.clear();
  const auto steps = [](const RecordedDrive& drive) { return drive.itinerary().steps(); };
  const Itinerary& longest = std::ranges::max_element(drives_, {}, steps)->itinerary();
  for (std::size_t k = itinerary_.steps(); k < longest.steps(); ++k) {
    itinerary_.step_time.push_back(std::max(itinerary_.step_time.back(), longest.step_time[k]));
  }
  for (std::size_t k = 1; k < drives_.size(); ++k)
    require_alike(drives_.front().itinerary(), drives_[k].itinerary(), k);
}

const Itinerary& SeveralDrives::itinerary_of(std::uint64_t run) const {
  return drives_.at(run).itinerary();
}

void SeveralDrives::generate(std::uint64_t run, Drive& drive) const {
  drives_.at(run).generate(run, drive);
}

DriveLog log_of(const Itinerary& itinerary, const Drive& drive, std::span<const Quantity> controls,
                std::vector<Eigen::Vector2d> landmarks, Identities identities) {
  expect(itinerary.has_truth, "a log is made of a drive whose truth is unknown");
  DriveLog log;
  log.start = itinerary.start;
  log.controls = controls;
  log.odometry = odometry_rows(itinerary, drive);
  for (std::size_t s = 0; s < itinerary.scans(); ++s) {
    log.scans.push_back(
        scan_of(itinerary.step_time[itinerary.scan_step[s]], drive.scan(s), identities));
  }
  log.references.push_back(truth_path(itinerary, drive));
  log.landmarks = std::move(landmarks);
  return log;
}

}  // namespace montecarta::experiments
