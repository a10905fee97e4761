// SPDX-License-Identifier: BSD-3-Clause
#include "engine/errors.hpp"
#include "experiments/files/csv_rows.hpp"
#include "experiments/recordings/drive_log.hpp"
#include "experiments/recordings/log_csv.hpp"
#include "experiments/recordings/log_csv_names.hpp"
#include "experiments/text/words.hpp"
#include "filters/models/vehicle_settings.hpp"

#include <algorithm>
#include <iterator>
#include <system_error>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

void read_start(const fs::path& path, DriveLog& log) {
  CsvRows rows(path, log_csv::kStart);
  const bool has_row = rows.next();
  if (has_row) {
    log.start_time = rows.number(0, "time");
    log.start = {.x = rows.number(1, "coordinate"),
                 .y = rows.number(2, "coordinate"),
                 .heading = rows.number(3, "heading")};
    if (!rows.next()) return;
  }
  throw StudyError(path.string() + ": " + (has_row ? "more than one row" : "no row") +
                   " (a drive starts at one pose): write one row");
}

/// The different sets of controls that vehicles have.
std::vector<std::span<const ControlName>> known_controls() {
  std::vector<std::span<const ControlName>> known;
  for_each_vehicle([&](const Vehicle& vehicle) { known.push_back(controls_of(vehicle)); });
  return known;
}

/// The columns say what kind of vehicle it is of.
void read_odometry(const fs::path& path, DriveLog& log) {
  const std::vector<std::span<const ControlName>> known = known_controls();
  std::vector<std::string> headers;
  for (const auto& controls : known) headers.push_back(log_csv::odometry_header(controls));
  CsvRows rows(path, headers);
  log.controls = known[rows.header()];
  while (rows.next()) {
    Odometry& odometry = log.odometry.emplace_back(Odometry{rows.number(0, "time"), {}});
    for (std::size_t c = 0; c < log.controls.size(); ++c) {
      odometry.control[c] = rows.number(c + 1, log.controls[c].noun);
    }
  }
  check_odometry(log.odometry, log.controls, path.string());
}

/// The whole number in a field; nullopt where it is empty.
std::optional<std::int32_t> identity_in(const CsvRows& rows, std::size_t column) {
  if (rows.field(column).empty()) return std::nullopt;
  const auto identity = to_count(rows.field(column));
  if (identity && *identity < kMostIdentities) return static_cast<std::int32_t>(*identity);
  throw StudyError(rows.place() + ": '" + excerpt(rows.field(column)) +
                   "' is no identity (a whole number from 0 to 999999): number the landmarks " +
                   "from 0, or leave the field empty for clutter");
}

Detection detection_in(const CsvRows& rows, std::span<const Quantity> components, bool identified) {
  Detection detection{.values = {}, .identity = Detection::kUnidentified};
  for (std::size_t i = 0; i < components.size(); ++i) {
    detection[i] = rows.number(i + 1, name_of(components[i]).name);
  }
  if (!identified) return detection;
  detection.identity = identity_in(rows, components.size() + 1).value_or(Detection::kClutter);
  return detection;
}

/// Nothing behind the time, in so many fields.
bool is_empty_scan(const CsvRows& rows, std::size_t fields) {
  for (std::size_t i = 1; i <= fields; ++i) {
    if (!rows.field(i).empty()) return false;
  }
  return true;
}

/// Headers of the detections of all sensors, two of each.
std::vector<std::string> known_detections() {
  std::vector<std::string> headers;
  for_each_sensor([&](const Sensor& sensor) {
    std::ranges::copy(log_csv::detection_headers(components_of(sensor)),
                      std::back_inserter(headers));
  });
  return headers;
}

/// The columns say what sensor it is of. Rows of one time make one scan; a row of a time alone is a
/// scan that saw nothing.
void read_scans(const fs::path& path, DriveLog& log) {
  CsvRows rows(path, known_detections());
  const bool identified = rows.header() % 2 == 1;
  std::size_t kind = 0;
  for_each_sensor([&](const Sensor& sensor) {
    if (kind++ == rows.header() / 2) log.components = components_of(sensor);
  });
  const std::size_t fields = log.components.size() + (identified ? 1 : 0);
  std::vector<LoggedScan>& scans = log.scans;
  while (rows.next()) {
    const double time = rows.number(0, "time");
    const bool nothing = is_empty_scan(rows, fields);
    const bool again = !scans.empty() && scans.back().time == time;
    if (again && (nothing || scans.back().detections.empty())) {
      throw StudyError(rows.place() + ": a scan at " + to_text(time) +
                       " s that saw nothing has other rows (it is one row): delete one of them");
    }
    if (!again) scans.push_back({time, {}});
    if (nothing) continue;
    scans.back().detections.push_back(detection_in(rows, log.components, identified));
  }
  check_scans(scans, path.string(), log.components);
}

/// By identity where that column is there: each from 0 on once.
std::vector<Eigen::Vector2d> read_landmarks(const fs::path& path) {
  CsvRows rows(path, log_csv::kLandmarks);
  std::vector<std::pair<std::int32_t, Eigen::Vector2d>> landmarks;
  while (rows.next()) {
    const auto next = static_cast<std::int32_t>(landmarks.size());
    const auto identity = rows.header() == 1 ? identity_in(rows, 2).value_or(-1) : next;
    landmarks.push_back({identity, {rows.number(0, "coordinate"), rows.number(1, "coordinate")}});
  }
  if (landmarks.empty()) {
    throw StudyError(path.string() + ": no landmarks (it is empty): add them, or remove the file");
  }
  std::ranges::stable_sort(landmarks, {}, [](const auto& landmark) { return landmark.first; });
  std::vector<Eigen::Vector2d> places;
  for (const auto& [identity, place] : landmarks) {
    if (identity != static_cast<std::int32_t>(places.size())) {
      throw StudyError(path.string() + ": no landmark of identity " +
                       std::to_string(places.size()) +
                       ", or two of the one before (they count from 0): number each row once");
    }
    places.push_back(place);
  }
  check_landmarks(places, path.string());
  return places;
}

/// The name of the reference in a file; empty where it holds none. A file that looks misspelt is
/// refused, for nobody would miss what it holds.
std::string reference_in(const fs::path& file) {
  std::string stem = file.stem().string();
  if (file.extension() != ".csv" || stem == "landmarks") return {};
  if (stem == log_csv::kLeading) return stem;
  const std::string prefix = log_csv::kLeading + "_";
  if (stem.starts_with(prefix) && stem != prefix) return stem.substr(prefix.size());
  if (!stem.starts_with("reference") && !stem.starts_with("landmark")) return {};
  throw StudyError(file.string() + ": no file of a log (known: reference.csv, " +
                   "reference_NAME.csv, landmarks.csv): rename it");
}

std::vector<ReferencePath> read_references(const fs::path& folder) {
  std::error_code failure;
  std::vector<ReferencePath> references;
  for (const auto& entry : fs::directory_iterator(folder, failure)) {
    const std::string name = reference_in(entry.path());
    if (!name.empty()) references.push_back(read_reference_csv(entry.path(), name));
  }
  std::ranges::sort(references, log_csv::is_before, &ReferencePath::name);
  return references;
}

}  // namespace

DriveLog read_log_csv(const fs::path& folder) {
  DriveLog log;
  read_start(folder / "start.csv", log);
  read_odometry(folder / "odometry.csv", log);
  read_scans(folder / "detections.csv", log);
  log.references = read_references(folder);
  if (fs::exists(folder / "landmarks.csv")) {
    log.landmarks = read_landmarks(folder / "landmarks.csv");
  }
  check_log(log, folder.string(), LogForm::csv);
  return log;
}

}  // namespace montecarta::experiments
