// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/recordings/drive_log.hpp"

#include "engine/errors.hpp"
#include "experiments/recordings/log_csv.hpp"
#include "experiments/text/words.hpp"
#include "experiments/worlds/world.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

namespace montecarta::experiments {
namespace {

constexpr double kLatestTime = 1e10;  ///< [s] larger numbers are probably nanoseconds
constexpr double kLongestHold = 5.0;  ///< [s] for which scans may continue after the odometry

/// A record of a file, for errors.
struct Record {
  const std::string& place;
  std::size_t index;
  std::optional<double> time = {};  ///< [s] that helps to find the record in its file

  [[noreturn]] void refuse(const std::string& fault) const {
    throw StudyError(place + ": record " + std::to_string(index + 1) +
                     (time ? ", at " + to_text(*time) + " s: " : ": ") + fault);
  }
  /// Throws unless |value| <= most, so also for NaN.
  void limit(double value, double most, const char* noun, const char* why) const {
    if (std::abs(value) <= most) return;
    refuse(std::string(noun) + " " + to_text(value) + " (" + why + "): correct it");
  }
  void place_on_map(const Eigen::Vector2d& point) const {
    for (const double coordinate : point) {
      limit(coordinate, kFarthestCoordinate, "coordinate",
            "metres from an origin nearby, not beyond 1e6 m");
    }
  }
};

/// Checks that `time(i)` of `count` records is plausible and later than the one before.
template <class Time>
void check_times(std::size_t count, const Time& time, const std::string& place) {
  if (count == 0) {
    throw StudyError(place + ": no records (it is empty): take a file with at least one");
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Record record{place, i};
    record.limit(time(i), kLatestTime, "time", "seconds, a finite number");
    if (i == 0 || time(i) > time(i - 1)) continue;
    record.refuse("time " + to_text(time(i)) + " s comes after " + to_text(time(i - 1)) +
                  " s (times must increase): bring the records into order, each once");
  }
}

void check_detection(const Detection& detection, std::span<const Quantity> components,
                     const Record& record) {
  for (std::size_t i = 0; i < components.size(); ++i) {
    const Component& component = component_of(components[i]);
    if (components[i] == Quantity::range && !(detection[i] > 0.0)) {
      record.refuse(std::string(component.name) + " " + to_text(detection[i]) +
                    " (a detection is farther than 0 m): correct it");
    }
    record.limit(detection[i], component.most, component.name, component.limit);
  }
  const std::int32_t identity = detection.identity;
  if (identity < Detection::kUnidentified || identity >= kMostIdentities) {
    record.refuse("identity " + std::to_string(identity) +
                  " (a whole number from 0 to 999999): number the landmarks from 0");
  }
}

/// Checks that identities are given for all detections of a log (clutter included) or for none.
void check_identities(const DriveLog& log, const std::string& place) {
  bool identified = false, unidentified = false;
  for (std::size_t s = 0; s < log.scans.size(); ++s) {
    std::set<std::int32_t> here;
    for (const Detection& detection : log.scans[s].detections) {
      const bool unknown = detection.identity == Detection::kUnidentified;
      (unknown ? unidentified : identified) = true;
      const Record record{place, s, log.scans[s].time};
      if (identified && unidentified) {
        record.refuse("some detections have an identity, others not (all or none): " +
                      std::string("give it for all"));
      }
      if (detection.identity >= 0 && !here.insert(detection.identity).second) {
        record.refuse("identity " + std::to_string(detection.identity) +
                      " twice (a scan sees a landmark once): correct one of the two");
      }
      if (log.landmarks.empty() || detection.identity < 0) continue;
      if (static_cast<std::size_t>(detection.identity) >= log.landmarks.size()) {
        record.refuse("identity " + std::to_string(detection.identity) + " of " +
                      std::to_string(log.landmarks.size()) +
                      " landmarks (they count from 0): give all landmarks, or none");
      }
    }
  }
}

bool is_name(const std::string& name) {
  const auto fits = [](unsigned char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  };
  return !name.empty() && name.size() <= 64 && std::ranges::all_of(name, fits);
}

/// Checks that covariances are given for all fixes or for none, with plausible standard deviations.
void check_covariances(const ReferencePath& reference, const std::string& place) {
  const std::vector<Eigen::Matrix3d>& covariance = reference.covariance;
  if (!covariance.empty() && covariance.size() != reference.time.size()) {
    throw StudyError(place + ": as many covariances as times are needed, or none: complete them");
  }
  for (std::size_t i = 0; i < covariance.size(); ++i) {
    for (int c = 0; c < reference.dimension(); ++c) {
      const bool is_heading = c == 2;
      Record{place, i}.limit(
          std::sqrt(covariance[i](c, c)), is_heading ? kPi : kFarthestCoordinate,
          is_heading ? "standard deviation of the heading" : "standard deviation of the position",
          is_heading ? "radians, at most pi" : "metres, at most 1e6");
    }
  }
}

void check_odometry(std::span<const Odometry> odometry, std::span<const Quantity> controls,
                    const std::string& place) {
  check_times(
      odometry.size(), [&](std::size_t i) { return odometry[i].time; }, place);
  for (std::size_t i = 0; i < odometry.size(); ++i) {
    const Record record{place, i};
    for (std::size_t c = 0; c < controls.size(); ++c) {
      const Component& control = component_of(controls[c]);
      record.limit(odometry[i].control[c], control.most, control.name, control.limit);
    }
  }
}

void check_scans(std::span<const LoggedScan> scans, const std::string& place,
                 std::span<const Quantity> components) {
  check_times(
      scans.size(), [&](std::size_t i) { return scans[i].time; }, place);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    for (const Detection& detection : scans[i].detections) {
      check_detection(detection, components, Record{place, i});
    }
  }
}

void check_reference(const ReferencePath& reference, const std::string& place) {
  const std::string& name = reference.name;
  const std::vector<double>&time = reference.time, &heading = reference.heading;
  const std::vector<Eigen::Vector2d>& position = reference.position;
  if (!is_name(name)) {
    throw StudyError(place + ": '" + excerpt(name) +
                     "' is no name of a reference (letters, digits, _ and -): rename it");
  }
  if (position.size() != time.size() || (!heading.empty() && heading.size() != time.size())) {
    throw StudyError(place + ": as many places, or headings, as times are needed (a fix has all " +
                     "or the reference has no headings): complete the records");
  }
  check_times(
      time.size(), [&time](std::size_t i) { return time[i]; }, place);
  for (std::size_t i = 0; i < position.size(); ++i) Record{place, i}.place_on_map(position[i]);
  for (std::size_t i = 0; i < heading.size(); ++i) {
    Record{place, i}.limit(heading[i], 1e3 * kPi, "heading", "radians");
  }
  check_covariances(reference, place);
}

void check_references(const DriveLog& log, const std::string& place) {
  std::set<std::string> names;
  for (const ReferencePath& reference : log.references) {
    check_reference(reference, place + "/" + file_of_reference(excerpt(reference.name)));
    if (names.insert(reference.name).second) continue;
    throw StudyError(place + ": two references called " + reference.name +
                     " (each has a name of its own): rename one");
  }
  if (names.empty()) {
    throw StudyError(place +
                     ": no reference (a drive is judged by one): add the fixes of a GPS, or "
                     "another measurement of the path");
  }
}

/// Refuses scans long after the last odometry. Odometry holds until its next record, so if none
/// follows for that long, the file was probably cut.
void check_end(const DriveLog& log, const std::string& place) {
  const double last_scan = log.scans.back().time, last_move = log.odometry.back().time;
  if (last_scan <= last_move + kLongestHold) return;
  throw StudyError(place + ": the last record is at " + to_text(last_move) +
                   " s, the last scan at " + to_text(last_scan) +
                   " s (the motion in between is unknown; was the file cut short?): "
                   "take the whole file, or leave out the scans");
}

/// Refuses scans before the start, where the pose is unknown, and odometry that ends before the
/// start.
void check_start(const DriveLog& log, const std::string& scans, const std::string& odometry) {
  const std::string start = to_text(log.start_time) + " s";
  if (log.scans.front().time < log.start_time) {
    throw StudyError(scans + ": the first is at " + to_text(log.scans.front().time) +
                     " s, before the start at " + start +
                     " (its pose is unknown): give an earlier start, or leave it out");
  }
  if (log.odometry.back().time < log.start_time) {
    throw StudyError(odometry + ": all of it is before the start at " + start +
                     " (the vehicle would never move): correct the time of the start");
  }
}

}  // namespace

void check_log(const DriveLog& log, const std::string& folder) {
  const std::string start = folder + "/start.csv", odometry = folder + "/odometry.csv",
                    scans = folder + "/detections.csv", landmarks = folder + "/landmarks.csv";
  Record{start, 0}.limit(log.start_time, kLatestTime, "time", "seconds, a finite number");
  Record{start, 0}.place_on_map({log.start.x, log.start.y});
  Record{start, 0}.limit(log.start.heading, 1e3 * kPi, "heading", "radians");
  check_odometry(log.odometry, log.controls, odometry);
  check_scans(log.scans, scans, log.components);
  check_references(log, folder);
  for (std::size_t i = 0; i < log.landmarks.size(); ++i)
    Record{landmarks, i}.place_on_map(log.landmarks[i]);
  check_identities(log, scans);
  check_start(log, scans, odometry);
  check_end(log, odometry);
}

}  // namespace montecarta::experiments
