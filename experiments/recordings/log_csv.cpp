// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/recordings/log_csv.hpp"

#include "analysis/output/csv_file.hpp"
#include "engine/errors.hpp"
#include "experiments/files/files.hpp"
#include "experiments/text/words.hpp"
#include "filters/models/vehicle_settings.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <iterator>
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

/// The time, then these controls or components of a detection.
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

void read_start(const fs::path& path, DriveLog& log) {
  CsvRows rows(path, kStartHeader);
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
    Odometry& odometry = log.odometry.emplace_back(Odometry{rows.number(0, "time"), {}});
    for (std::size_t c = 0; c < log.controls.size(); ++c) {
      odometry.control[c] = rows.number(c + 1, component_of(log.controls[c]).name);
    }
  }
}

/// The identity in a field; nullopt if the field is empty.
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
    detection[i] = rows.number(i + 1, component_of(components[i]).name);
  }
  if (!identified) return detection;
  detection.identity = identity_in(rows, components.size() + 1).value_or(Detection::kClutter);
  return detection;
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

/// Reads the scans. Their columns determine the sensor. Rows with the same time form one scan; a
/// row with only a time is a scan without detections.
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
}

/// Reads the landmarks. If there is a column of identities, every identity from 0 on must occur
/// once.
std::vector<Eigen::Vector2d> read_landmarks(const fs::path& path) {
  CsvRows rows(path, kLandmarkHeaders);
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
  std::ranges::sort(references, is_read_before, &ReferencePath::name);
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
  check_log(log, folder.string());
  return log;
}

namespace {

namespace fs = std::filesystem;

/// The text of a file, built row by row.
class Table {
 public:
  explicit Table(const std::string& header) : text_(header + "\n") {}

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

Table odometry_table(const DriveLog& log) {
  Table table(header_of(log.controls));
  for (const auto& [time, control] : log.odometry) {
    std::array<double, 1 + Control::kMost> row{time};
    std::ranges::copy(control.values, row.begin() + 1);
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

Table detection_table(const DriveLog& log) {
  const bool identified = is_identified(log);
  const std::size_t n = log.components.size();
  Table table(detection_headers(log.components)[identified ? 1 : 0]);
  for (const auto& [time, detections] : log.scans) {
    if (detections.empty()) table.add({time}, std::string(identified ? n + 1 : n, ','));
    for (const Detection& detection : detections) {
      std::array<double, 1 + Detection::kMost> row{time};
      std::ranges::copy(detection.values, row.begin() + 1);
      table.add(std::span(row).first(1 + n), identified ? identity_field(detection) : "");
    }
  }
  return table;
}

void check_order(const DriveLog& log, const std::string& place) {
  if (std::ranges::is_sorted(log.references, is_read_before, &ReferencePath::name)) return;
  throw StudyError(place + ": references are not in the order of their names (in which they will " +
                   "be read): rename them, or call the leading one 'reference'");
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
  check_log(log, folder.string());
  check_order(log, folder.string());
  make_folder(folder);
  make_folder(truth_folder);
  Table start(kStartHeader[0]);
  start.add({log.start_time, log.start.x, log.start.y, log.start.heading});
  write_text(folder / "start.csv", start.text());
  write_text(folder / "odometry.csv", odometry_table(log).text());
  write_text(folder / "detections.csv", detection_table(log).text());
  for (const ReferencePath& reference : log.references) {
    write_text(truth_folder / file_of_reference(reference.name), csv_of(reference));
  }
  Table landmarks(kLandmarkHeaders[0]);
  for (const Eigen::Vector2d& place : log.landmarks) landmarks.add({place.x(), place.y()});
  if (!log.landmarks.empty()) write_text(truth_folder / "landmarks.csv", landmarks.text());
}

namespace {

constexpr double kLeastDeviation = 1e-9;  // [m, rad]

/// Diagonal covariance from standard deviations in the fields from `first` on.
Eigen::Matrix3d covariance_of_sigmas(const CsvRows& rows, std::size_t first, int dimension) {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (int i = 0; i < dimension; ++i) {
    const std::size_t field = first + static_cast<std::size_t>(i);
    const double sigma = rows.number(field, "standard deviation");
    if (!(sigma >= kLeastDeviation)) {
      throw StudyError(rows.place() + ": standard deviation " + std::string(rows.field(field)) +
                       " (every fix has an error, at least 1e-9 m or rad): correct it, or leave "
                       "the sigmas out if they are unknown");
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

/// Covariance from its lower triangle, row by row, in the fields from `first` on.
Eigen::Matrix3d covariance_in(const CsvRows& rows, std::size_t first, int dimension) {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  std::size_t field = first;
  for (int i = 0; i < dimension; ++i) {
    for (int j = 0; j <= i; ++j) {
      covariance(i, j) = covariance(j, i) = rows.number(field++, "covariance");
    }
  }
  if (is_positive_definite(covariance, dimension)) return covariance;
  throw StudyError(rows.place() +
                   ": the covariance is not positive definite (variances must be above 0 and "
                   "correlations between -1 and 1): correct it, or give standard deviations");
}

}  // namespace

ReferencePath read_reference_csv(const std::filesystem::path& path, const std::string& name) {
  CsvRows rows(path, kReferenceHeaders);
  const bool headed = rows.header() % 2 == 1;
  const std::size_t behind = headed ? 4 : 3;  // the first field that is neither time nor pose
  ReferencePath reference{.name = name, .time = {}, .position = {}, .heading = {}};
  while (rows.next()) {
    reference.time.push_back(rows.number(0, "time"));
    reference.position.emplace_back(rows.number(1, "coordinate"), rows.number(2, "coordinate"));
    if (headed) reference.heading.push_back(rows.number(3, "heading"));
    const int dimension = reference.dimension();
    if (rows.header() >= kWithCovariance) {
      reference.covariance.push_back(covariance_in(rows, behind, dimension));
    } else if (rows.header() >= kWithSigmas) {
      reference.covariance.push_back(covariance_of_sigmas(rows, behind, dimension));
    }
  }
  return reference;
}

std::string csv_of(const ReferencePath& reference) {
  const bool headed = !reference.heading.empty(), known = !reference.covariance.empty();
  Table table(kReferenceHeaders[(known ? kWithCovariance : 0) + (headed ? 1 : 0)]);
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
