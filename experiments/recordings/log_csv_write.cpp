// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/csv_file.hpp"
#include "engine/errors.hpp"
#include "experiments/recordings/drive_log.hpp"
#include "experiments/recordings/log_csv.hpp"
#include "experiments/recordings/log_csv_names.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <span>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

/// A file as text, row by row.
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
  void save(const fs::path& path) const { write_text(path, text_); }

 private:
  std::string text_;
};

Table start_table(double time, const Pose& start) {
  Table table(log_csv::kStart[0]);
  table.add({time, start.x, start.y, start.heading});
  return table;
}

Table odometry_table(const DriveLog& log) {
  Table table(log_csv::odometry_header(log.controls));
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
  Table table(log_csv::detection_headers(log.components)[identified ? 1 : 0]);
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

Table landmark_table(const std::vector<Eigen::Vector2d>& landmarks) {
  Table table(log_csv::kLandmarks[0]);
  for (const Eigen::Vector2d& place : landmarks) table.add({place.x(), place.y()});
  return table;
}

void check_order(const DriveLog& log, const std::string& place) {
  if (std::ranges::is_sorted(log.references, log_csv::is_before, &ReferencePath::name)) return;
  throw StudyError(place + ": references are not in the order of their names (in which they will " +
                   "be read): rename them, or call the leading one 'reference'");
}

void make_folder(const fs::path& folder) {
  make_directory(folder);
  if (fs::is_empty(folder)) return;
  throw StudyError(folder.string() +
                   ": not empty (what lies there would be read with the log): name a new folder");
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
  start_table(log.start_time, log.start).save(folder / "start.csv");
  odometry_table(log).save(folder / "odometry.csv");
  detection_table(log).save(folder / "detections.csv");
  for (const ReferencePath& reference : log.references) {
    write_text(truth_folder / log_csv::file_of_reference(reference.name), csv_of(reference));
  }
  if (!log.landmarks.empty()) landmark_table(log.landmarks).save(truth_folder / "landmarks.csv");
}

}  // namespace montecarta::experiments
