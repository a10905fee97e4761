// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/recordings/log_csv.hpp"

#include "analysis/study/frame.hpp"
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "experiments/files/files.hpp"
#include "experiments/text/words.hpp"
#include "experiments/worlds/world.hpp"
#include "filters/models/vehicle_settings.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <set>
#include <span>
#include <system_error>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

/// Headers of a file of a log, without and with its optional last column.
using Headers = std::array<std::string, 2>;

const std::array<std::string, 1> kStartHeader = {"time_s,x_m,y_m,heading_rad"};
const Headers kLandmarkHeaders = {"x_m,y_m", "x_m,y_m,identity"};
/// Headers of a reference: a position or a pose, without errors, with their standard deviations and
/// with their covariance.
const std::array<std::string, 6> kReferenceHeaders = {
    "time_s,x_m,y_m",
    "time_s,x_m,y_m,heading_rad",
    "time_s,x_m,y_m,sigma_x_m,sigma_y_m",
    "time_s,x_m,y_m,heading_rad,sigma_x_m,sigma_y_m,sigma_heading_rad",
    "time_s,x_m,y_m,var_x_m2,cov_x_y_m2,var_y_m2",
    "time_s,x_m,y_m,heading_rad,var_x_m2,cov_x_y_m2,var_y_m2,"
    "cov_x_heading_m_rad,cov_y_heading_m_rad,var_heading_rad2"};
constexpr std::size_t kWithSigmas = 2, kWithCovariance = 4;

/// The end of an error that names the script for logs as robots write them.
const std::string kOrRepair =
    ", or repair the log (python3 experiments/convert/repair_log.py FOLDER -o NEW_FOLDER)";

/// Makes a header of the time and then of these controls or these components of a detection.
std::string header_of(std::span<const Quantity> quantities) {
  std::string header = "time_s";
  for (const Quantity quantity : quantities)
    header.append(",").append(component_of(quantity).column);
  return header;
}

Headers detection_headers(std::span<const Quantity> components) {
  const std::string header = header_of(components);
  return {header, header + ",identity"};
}

/// Returns whether reference `a` is read before `b`.
bool is_read_before(const std::string& a, const std::string& b) {
  return a != b && (a == kLeadingReference || (b != kLeadingReference && a < b));
}

/// A number whose magnitude is at most `most`. `why` gives its unit and range in errors.
double limited(const CsvRows& rows, std::size_t field, const char* noun, double most,
               const char* why) {
  const double value = rows.number(field, noun);
  if (std::abs(value) <= most) return value;
  rows.refuse(formatted("{} {} ({}): correct it", noun, to_text(value), why));
}

double time_in(CsvRows& rows, CsvRows::Order order = CsvRows::Order::later) {
  constexpr double kLatestTime = 1e10;  // larger numbers are probably nanoseconds
  limited(rows, 0, "time", kLatestTime, "seconds, at most 1e10");
  return rows.time(order, kOrRepair);
}

Eigen::Vector2d point_in(const CsvRows& rows, std::size_t first) {
  constexpr const char* kWhy = "metres from an origin nearby, not beyond 1e6 m";
  return {limited(rows, first, "coordinate", kFarthestCoordinate, kWhy),
          limited(rows, first + 1, "coordinate", kFarthestCoordinate, kWhy)};
}

double heading_in(const CsvRows& rows, std::size_t field) {
  return limited(rows, field, "heading", 1e3 * kPi, "radians");
}

/// The reason why `value` cannot be a control or a component of a detection; empty if it can.
std::string fault_of(double value, Quantity quantity) {
  const Component& component = component_of(quantity);
  const bool is_too_near = quantity == Quantity::range && value <= 0.0;
  if (std::abs(value) <= component.most && !is_too_near) return {};
  return formatted("{} {} ({})", component.name, to_text(value),
                   is_too_near ? "a detection is farther than 0 m" : component.limit);
}

double quantity_in(const CsvRows& rows, std::size_t field, Quantity quantity) {
  const double value = rows.number(field, component_of(quantity).name);
  const std::string fault = fault_of(value, quantity);
  if (!fault.empty()) rows.refuse(fault + ": correct it");
  return value;
}

void read_start(const fs::path& path, DriveLog& log) {
  CsvRows rows(path, kStartHeader);
  const bool has_row = rows.next();
  if (has_row) {
    log.start_time = time_in(rows);
    const Eigen::Vector2d place = point_in(rows, 1);
    log.start = {.x = place.x(), .y = place.y(), .heading = heading_in(rows, 3)};
    if (!rows.next()) return;
  }
  throw StudyError("{}: {} (a drive starts at one pose): write one row", path,
                   has_row ? "more than one row" : "no row");
}

/// Reads the odometry. Its columns determine the components of the controls.
void read_odometry(const fs::path& path, DriveLog& log) {
  std::vector<std::span<const Quantity>> known;
  std::vector<std::string> headers;
  for_each_vehicle([&](const Vehicle& vehicle) {
    known.push_back(controls_of(vehicle));
    headers.push_back(header_of(known.back()));
  });
  CsvRows rows(path, headers);
  log.controls = known[rows.header()];
  while (rows.next()) {
    Odometry& odometry = log.odometry.emplace_back(Odometry{time_in(rows), {}});
    for (std::size_t c = 0; c < log.controls.size(); ++c)
      odometry.control[c] = quantity_in(rows, c + 1, log.controls[c]);
  }
  rows.require_some();
}

/// The identity in a field; nullopt if the field is empty.
std::optional<std::int32_t> identity_in(const CsvRows& rows, std::size_t column) {
  constexpr std::uint64_t kMostIdentities = 1'000'000;  // no map has so many landmarks
  if (rows.field(column).empty()) return std::nullopt;
  const auto identity = to_count(rows.field(column));
  if (identity && *identity < kMostIdentities) return static_cast<std::int32_t>(*identity);
  rows.refuse(
      formatted("'{}' is no identity (a whole number from 0 to 999999): number the landmarks from "
                "0, or leave the field empty for clutter",
                excerpt(rows.field(column))));
}

Detection detection_in(const CsvRows& rows, std::span<const Quantity> components, bool identified) {
  Detection detection{.values = {}, .identity = Detection::kUnidentified};
  for (std::size_t i = 0; i < components.size(); ++i)
    detection[i] = quantity_in(rows, i + 1, components[i]);
  if (!identified) return detection;
  detection.identity = identity_in(rows, components.size() + 1).value_or(Detection::kClutter);
  return detection;
}

/// Refuses a detection of a landmark that the scan has already `seen`, or that does not exist.
void check_identity(const CsvRows& rows, std::int32_t identity, std::size_t known,
                    std::set<std::int32_t>& seen) {
  if (identity < 0) return;
  const std::string name = "identity " + std::to_string(identity);
  if (!seen.insert(identity).second)
    rows.refuse(formatted("{} twice (a scan sees a landmark once): correct one of the two{}", name,
                          kOrRepair));
  if (known == 0 || static_cast<std::size_t>(identity) < known) return;
  rows.refuse(formatted("{} of {} landmarks (they count from 0): give all landmarks, or none", name,
                        known));
}

/// Returns whether all fields behind the time are empty.
bool is_empty_scan(const CsvRows& rows, std::size_t fields) {
  for (std::size_t i = 1; i <= fields; ++i) {
    if (!rows.field(i).empty()) return false;
  }
  return true;
}

/// Headers of the detections of all sensors, two for each sensor.
std::vector<std::string> known_detections() {
  std::vector<std::string> headers;
  for_each_sensor([&](const Sensor& sensor) {
    std::ranges::copy(detection_headers(components_of(sensor)), std::back_inserter(headers));
  });
  return headers;
}

/// Reads the scans, after the landmarks. Their columns determine the sensor. Rows with the same
/// time form one scan; a row with only a time is a scan without detections.
void read_scans(const fs::path& path, DriveLog& log) {
  CsvRows rows(path, known_detections());
  const bool identified = rows.header() % 2 == 1;
  std::size_t kind = 0;
  for_each_sensor([&](const Sensor& sensor) {
    if (kind++ == rows.header() / 2) log.components = components_of(sensor);
  });
  const std::size_t fields = log.components.size() + (identified ? 1 : 0);
  std::vector<LoggedScan>& scans = log.scans;
  std::set<std::int32_t> seen;  // identities in the last scan
  while (rows.next()) {
    const double time = time_in(rows, CsvRows::Order::not_earlier);
    const bool nothing = is_empty_scan(rows, fields);
    const bool again = !scans.empty() && scans.back().time == time;
    if (again && (nothing || scans.back().detections.empty())) {
      rows.refuse(formatted(
          "a scan at {} s that saw nothing has other rows (it is one row): delete one of them",
          to_text(time)));
    }
    if (!again) {
      scans.push_back({time, {}});
      seen.clear();
    }
    if (nothing) continue;
    const Detection detection = detection_in(rows, log.components, identified);
    check_identity(rows, detection.identity, log.landmarks.size(), seen);
    scans.back().detections.push_back(detection);
  }
  rows.require_some();
}

/// Reads the landmarks. If there is a column of identities, every identity from 0 on must occur
/// once.
std::vector<Eigen::Vector2d> read_landmarks(const fs::path& path) {
  CsvRows rows(path, kLandmarkHeaders);
  std::vector<std::pair<std::int32_t, Eigen::Vector2d>> landmarks;
  while (rows.next()) {
    const auto next = static_cast<std::int32_t>(landmarks.size());
    const auto identity = rows.header() == 1 ? identity_in(rows, 2).value_or(-1) : next;
    landmarks.emplace_back(identity, point_in(rows, 0));
  }
  if (landmarks.empty()) {
    throw StudyError(path.string() +
                     ": no rows (every landmark has one): add them, or remove the file");
  }
  std::ranges::stable_sort(landmarks, {}, [](const auto& landmark) { return landmark.first; });
  std::vector<Eigen::Vector2d> places;
  for (const auto& [identity, place] : landmarks) {
    if (identity != static_cast<std::int32_t>(places.size())) {
      throw StudyError(
          "{}: no landmark of identity {}, or two of the one before (they count from 0): number "
          "each row once",
          path, places.size());
    }
    places.push_back(place);
  }
  return places;
}

/// The name of the reference in a file; empty if the file is no reference. Throws StudyError if the
/// file name looks misspelt, because the file would be ignored unnoticed.
std::string reference_in(const fs::path& file) {
  std::string stem = file.stem().string();
  if (file.extension() != ".csv" || stem == "landmarks") return {};
  if (stem == kLeadingReference) return stem;
  const std::string prefix = kLeadingReference + "_";
  if (stem.starts_with(prefix) && stem != prefix) return stem.substr(prefix.size());
  if (!stem.starts_with("reference") && !stem.starts_with("landmark")) return {};
  throw StudyError(
      "{}: no file of a log (known: reference.csv, reference_NAME.csv, landmarks.csv): rename it",
      file);
}

bool is_name(const std::string& name) {
  constexpr const char* kAllowed =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
  return name.size() <= 64 && name.find_first_not_of(kAllowed) == name.npos;
}

std::vector<ReferencePath> read_references(const fs::path& folder) {
  std::error_code failure;
  std::vector<ReferencePath> references;
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder, failure)) {
    const std::string name = reference_in(entry.path());
    if (name.empty()) continue;
    if (!is_name(name)) {
      throw StudyError("{}: '{}' is no name of a reference (letters, digits, _ and -): rename it",
                       entry.path(), excerpt(name));
    }
    if (!names.insert(name).second) {
      throw StudyError("{}: two references called {} (each has a name of its own): rename one",
                       folder, name);
    }
    references.push_back(read_reference_csv(entry.path(), name));
  }
  std::ranges::sort(references, is_read_before, &ReferencePath::name);
  return references;
}

/// Refuses scans before the start, where the pose is unknown, odometry that ends before the start,
/// and scans long after the last odometry. Odometry holds until its next record, so if none follows
/// for that long, the file was probably cut.
void check_times(const DriveLog& log, const fs::path& folder) {
  constexpr double kLongestHold = 5.0;  // [s] longest time without odometry
  const std::string scans = (folder / "detections.csv").string();
  const std::string odometry = (folder / "odometry.csv").string();
  const double first_scan = log.scans.front().time, last_scan = log.scans.back().time;
  const double last_move = log.odometry.back().time;
  const std::string start = to_text(log.start_time) + " s";
  if (first_scan < log.start_time) {
    throw StudyError(
        "{}: the first is at {} s, before the start at {} (its pose is unknown): give an earlier "
        "start, or leave it out",
        scans, to_text(first_scan), start);
  }
  if (last_move < log.start_time) {
    throw StudyError(
        "{}: all of it is before the start at {} (the vehicle would never move): correct the time "
        "of the start",
        odometry, start);
  }
  if (last_scan <= last_move + kLongestHold) return;
  throw StudyError(
      "{}: the last record is at {} s, the last scan at {} s (the motion in between is unknown; "
      "was the file cut short?): take the whole file, or leave out the scans",
      odometry, to_text(last_move), to_text(last_scan));
}

}  // namespace

DriveLog read_log_csv(const fs::path& folder) {
  DriveLog log;
  read_start(folder / "start.csv", log);
  read_odometry(folder / "odometry.csv", log);
  if (fs::exists(folder / "landmarks.csv"))
    log.landmarks = read_landmarks(folder / "landmarks.csv");
  read_scans(folder / "detections.csv", log);
  log.references = read_references(folder);
  check_times(log, folder);
  return log;
}

namespace {

/// The text of a file, built row by row.
class LogTable {
 public:
  explicit LogTable(const std::string& header) : text_(header + "\n") {}

  void add(std::initializer_list<double> numbers, const std::string& rest = "") {
    add(std::span(numbers.begin(), numbers.size()), rest);
  }
  void add(std::span<const double> numbers, const std::string& rest = "") {
    for (const double number : numbers) {
      if (text_.back() != '\n') text_ += ',';
      text_ += to_text(number);
    }
    text_ += rest + "\n";
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// Throws StudyError for numbers that read_log_csv() would refuse.
void require_readable(std::span<const double> values, std::span<const Quantity> quantities,
                      const fs::path& file) {
  for (std::size_t i = 0; i < quantities.size(); ++i) {
    const std::string fault = fault_of(values[i], quantities[i]);
    if (fault.empty()) continue;
    throw StudyError("{}: {}, so that the log could not be read: give the study less noise", file,
                     fault);
  }
}

LogTable odometry_table(const DriveLog& log, const fs::path& file) {
  LogTable table(header_of(log.controls));
  for (const auto& [time, control] : log.odometry) {
    std::array<double, 1 + Control::kMost> row{time};
    std::ranges::copy(control.values, row.begin() + 1);
    require_readable(control.values, log.controls, file);
    table.add(std::span(row).first(1 + log.controls.size()));
  }
  return table;
}

bool is_identified(const DriveLog& log) {
  return std::ranges::any_of(log.scans, [](const LoggedScan& scan) {
    return !scan.detections.empty() && scan.detections.front().identity != Detection::kUnidentified;
  });
}

std::string identity_field(const Detection& detection) {
  return detection.identity < 0 ? "," : "," + std::to_string(detection.identity);
}

LogTable detection_table(const DriveLog& log, const fs::path& file) {
  const bool identified = is_identified(log);
  const std::size_t n = log.components.size();
  LogTable table(detection_headers(log.components)[identified ? 1 : 0]);
  for (const auto& [time, detections] : log.scans) {
    if (detections.empty()) table.add({time}, std::string(identified ? n + 1 : n, ','));
    for (const Detection& detection : detections) {
      std::array<double, 1 + Detection::kMost> row{time};
      std::ranges::copy(detection.values, row.begin() + 1);
      require_readable(detection.values, log.components, file);
      table.add(std::span(row).first(1 + n), identified ? identity_field(detection) : "");
    }
  }
  return table;
}

void make_folder(const fs::path& folder) {
  make_directory(folder);
  if (fs::is_empty(folder)) return;
  throw StudyError(folder.string() +
                   ": not empty (other files would be read with the log): name a new folder");
}

}  // namespace

void write_log_csv(const DriveLog& log, const fs::path& folder) {
  write_log_csv(log, folder, folder);
}

void write_log_csv(const DriveLog& log, const fs::path& folder, const fs::path& truth_folder) {
  const fs::path odometry_file = folder / "odometry.csv",
                 detection_file = folder / "detections.csv";
  const LogTable odometry = odometry_table(log, odometry_file);
  const LogTable detections = detection_table(log, detection_file);
  make_folder(folder);
  make_folder(truth_folder);
  LogTable start(kStartHeader[0]);
  start.add({log.start_time, log.start.x, log.start.y, log.start.heading});
  write_text(folder / "start.csv", start.text());
  write_text(odometry_file, odometry.text());
  write_text(detection_file, detections.text());
  for (const ReferencePath& reference : log.references) {
    write_text(truth_folder / file_of_reference(reference.name), csv_of(reference));
  }
  if (!log.landmarks.empty()) write_landmarks_csv(log.landmarks, truth_folder);
}

void write_landmarks_csv(std::span<const Eigen::Vector2d> landmarks, const fs::path& folder) {
  LogTable table(kLandmarkHeaders[0]);
  for (const Eigen::Vector2d& place : landmarks) table.add({place.x(), place.y()});
  write_text(folder / "landmarks.csv", table.text());
}

namespace {

constexpr double kLeastDeviation = 1e-9;  // [m, rad] least standard deviation

/// The diagonal covariance of the standard deviations in the fields from `first` on.
Eigen::Matrix3d covariance_of_sigmas(const CsvRows& rows, std::size_t first, int dimension) {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (int i = 0; i < dimension; ++i) {
    const std::size_t field = first + static_cast<std::size_t>(i);
    const double sigma = rows.number(field, "standard deviation");
    if (!(sigma >= kLeastDeviation)) {
      rows.refuse(
          formatted("standard deviation {} (every fix has an error, at least 1e-9 m or rad): "
                    "correct it, or leave the sigmas out if they are unknown",
                    rows.field(field)));
    }
    covariance(i, i) = sigma * sigma;
  }
  return covariance;
}

bool is_positive_definite(const Eigen::Matrix3d& covariance, int dimension) {
  const Eigen::VectorXd variances = covariance.diagonal().head(dimension);
  if (!(variances.array() >= kLeastDeviation * kLeastDeviation).all()) return false;
  const Eigen::VectorXd scale = variances.cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlation =
      scale.asDiagonal() * covariance.topLeftCorner(dimension, dimension) * scale.asDiagonal();
  constexpr double kLeastPivot = 1e-9;
  const Eigen::LLT<Eigen::MatrixXd> factor(correlation);
  return factor.info() == Eigen::Success &&
         (factor.matrixLLT().diagonal().array().square() > kLeastPivot).all();
}

/// The covariance whose lower triangle is, row by row, in the fields from `first` on.
Eigen::Matrix3d covariance_in(const CsvRows& rows, std::size_t first, int dimension) {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  std::size_t field = first;
  for (int i = 0; i < dimension; ++i) {
    for (int j = 0; j <= i; ++j) {
      covariance(i, j) = covariance(j, i) = rows.number(field++, "covariance");
    }
  }
  if (is_positive_definite(covariance, dimension)) return covariance;
  rows.refuse(
      "the covariance is not positive definite (variances must be above 0 and correlations between "
      "-1 and 1): correct it, or give standard deviations");
}

/// Refuses errors that are larger than any map or turn.
void check_size(const CsvRows& rows, const Eigen::Matrix3d& covariance, int dimension) {
  for (int i = 0; i < dimension; ++i) {
    const double sigma = std::sqrt(covariance(i, i));
    if (sigma <= (i == 2 ? kPi : kFarthestCoordinate)) continue;
    rows.refuse(
        formatted("standard deviation {} of the {}: correct it", to_text(sigma),
                  i == 2 ? "heading (radians, at most pi)" : "position (metres, at most 1e6)"));
  }
}

}  // namespace

ReferencePath read_reference_csv(const std::filesystem::path& path, const std::string& name) {
  CsvRows rows(path, kReferenceHeaders);
  const bool headed = rows.header() % 2 == 1;
  const std::size_t behind = headed ? 4 : 3;  // the first field that is neither time nor pose
  ReferencePath reference{.name = name, .time = {}, .position = {}, .heading = {}};
  while (rows.next()) {
    reference.time.push_back(time_in(rows));
    reference.position.push_back(point_in(rows, 1));
    if (headed) reference.heading.push_back(heading_in(rows, 3));
    const int dimension = reference.dimension();
    if (rows.header() >= kWithCovariance) {
      reference.covariance.push_back(covariance_in(rows, behind, dimension));
    } else if (rows.header() >= kWithSigmas) {
      reference.covariance.push_back(covariance_of_sigmas(rows, behind, dimension));
    }
    if (!reference.covariance.empty()) check_size(rows, reference.covariance.back(), dimension);
  }
  rows.require_some();
  return reference;
}

std::string csv_of(const ReferencePath& reference) {
  const bool headed = !reference.heading.empty(), known = !reference.covariance.empty();
  LogTable table(kReferenceHeaders[(known ? kWithCovariance : 0) + (headed ? 1 : 0)]);
  for (std::size_t f = 0; f < reference.time.size(); ++f) {
    std::vector<double> row = {reference.time[f], reference.position[f].x(),
                               reference.position[f].y()};
    if (headed) row.push_back(reference.heading[f]);
    for (int i = 0; known && i < reference.dimension(); ++i) {
      for (int j = 0; j <= i; ++j) row.push_back(reference.covariance[f](i, j));
    }
    table.add(row);
  }
  return table.text();
}

}  // namespace montecarta::experiments
