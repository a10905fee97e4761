// SPDX-License-Identifier: BSD-3-Clause
#include "engine/errors.hpp"
#include "experiments/files/mat_file.hpp"
#include "experiments/files/number_records.hpp"
#include "experiments/recordings/drive_log.hpp"
#include "experiments/recordings/laser.hpp"
#include "experiments/recordings/mat_drive.hpp"
#include "experiments/recordings/published_drives.hpp"
#include "experiments/recordings/sensor_events.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

constexpr double kVictoriaParkHeading = 35.5 * std::numbers::pi / 180.0;
constexpr double kMatClockAhead = 20967.0;  ///< [ms] of the .mat release's clock on the text's
constexpr unsigned kRangeBits = 0x1fff;     ///< of a stored echo: centimetres; above: intensity

/// The time of the text release [s] that a .mat file calls `milliseconds`.
double text_time(double milliseconds) { return (milliseconds - kMatClockAhead) / 1000.0; }

std::vector<double> text_times(std::vector<double> milliseconds) {
  for (double& time : milliseconds) time = text_time(time);
  return milliseconds;
}

std::vector<Odometry> calibrated_odometry(const fs::path& path) {
  NumberRecords records(path, 3, RecordEnd::lines);
  std::vector<Odometry> odometry;
  while (const auto record = records.next()) {
    odometry.push_back({(*record)[0], {(*record)[1], (*record)[2]}});
  }
  check_odometry(odometry, controls_of(Car()), path.string());
  return odometry;
}

std::vector<Odometry> raw_odometry(const fs::path& path) {
  const MatFile file(path);
  return odometry_of(file, text_times(file.series("time")), "speed", "steering");
}

std::vector<LoggedScan> text_scans(const fs::path& path) {
  NumberRecords records(path, 1 + kLaserBeams, RecordEnd::stream);
  std::vector<LoggedScan> scans;
  while (const auto record = records.next()) {
    const LaserSweep ranges = record->subspan<1, kLaserBeams>();
    check_sweep(ranges, records.place());
    scans.push_back({(*record)[0], detect_trees(ranges)});
  }
  check_scans(scans, path.string());
  return scans;
}

/// [m] of an echo as the laser sent it: whole numbers of 16 bits.
double range_of(double echo, const std::string& place) {
  if (!(echo >= 0 && echo <= 0xffff && echo == std::floor(echo))) {
    throw StudyError(place + ": an echo is no whole number of 16 bits (range and intensity in " +
                     "one): take the file as published");
  }
  return (static_cast<unsigned>(echo) & kRangeBits) / 100.0;
}

std::vector<LoggedScan> mat_scans(const fs::path& path) {
  const MatFile file(path);
  const SweepMatrix echoes(file, "LASER");
  return scans_of(file, text_times(file.series("TLsr")), echoes.scans(), [&](std::size_t s) {
    std::array<double, kLaserBeams> ranges = echoes.sweep(s);
    for (double& range : ranges) range = range_of(range, scan_place(file, s));
    return detect_trees(ranges);
  });
}

/// LASER.txt is missed by its name where neither is there.
std::vector<LoggedScan> scans_in(const fs::path& folder) {
  const bool mat_only = !fs::exists(folder / "LASER.txt") && fs::exists(folder / "aa3_lsr2.mat");
  return mat_only ? mat_scans(folder / "aa3_lsr2.mat") : text_scans(folder / "LASER.txt");
}

ReferencePath text_gps(const fs::path& path) {
  NumberRecords records(path, 3, RecordEnd::lines);
  ReferencePath gps{.name = "gps", .time = {}, .position = {}, .heading = {}};
  while (const auto record = records.next()) {  // time, North, East
    gps.time.push_back((*record)[0]);
    gps.position.emplace_back((*record)[2], (*record)[1]);
  }
  check_reference(gps, path.string());
  return gps;
}

/// The fixes of the .mat release stand on another origin.
ReferencePath mat_gps(const fs::path& path) {
  const MatFile file(path);
  ReferencePath gps =
      reference_of(file, "gps_all", text_times(file.series("timeGps")), "Lo_m", "La_m");
  const Eigen::Vector2d origin = gps.position.front();
  for (Eigen::Vector2d& position : gps.position) position -= origin;
  return gps;
}

std::vector<ReferencePath> references_in(const fs::path& folder) {
  std::vector<ReferencePath> references;
  const bool has_all = fs::exists(folder / "aa3_gpsx.mat");
  if (!has_all || fs::exists(folder / "GPS.txt"))
    references.push_back(text_gps(folder / "GPS.txt"));
  if (has_all) references.push_back(mat_gps(folder / "aa3_gpsx.mat"));
  return references;
}

std::vector<double> times_of(const auto& records) {
  std::vector<double> times;
  for (const auto& record : records) times.push_back(record.time);
  return times;
}

SensorEvents events_in(const fs::path& path) {
  NumberRecords records(path, 3, RecordEnd::lines);
  SensorEvents events;
  while (const auto record = records.next()) {
    events.time.push_back((*record)[0]);
    events.sensor.push_back((*record)[1]);
    events.index.push_back((*record)[2]);
  }
  return events;
}

/// Only records of text files are listed; what came from .mat is passed over.
void check_manager(const fs::path& path, const DriveLog& log, Steering steering) {
  const bool text_laser = fs::exists(path.parent_path() / "LASER.txt");
  const bool text_wheel = steering == Steering::calibrated;
  const std::vector<double> laser = text_laser ? times_of(log.scans) : std::vector<double>();
  const std::vector<double> wheel = text_wheel ? times_of(log.odometry) : std::vector<double>();
  const ReferencePath& first = log.references.front();
  const std::vector<double> gps = first.name == "gps" ? first.time : std::vector<double>();
  check_events(events_in(path), {gps, wheel, laser}, path.string());
}

}  // namespace

DriveLog read_victoria_park(const fs::path& folder, Steering steering) {
  DriveLog log;
  log.odometry = steering == Steering::calibrated ? calibrated_odometry(folder / "DRS.txt")
                                                  : raw_odometry(folder / "aa3_dr.mat");
  log.scans = scans_in(folder);
  log.references = references_in(folder);
  const Eigen::Vector2d& first = log.references.front().position.front();
  log.start_time = log.references.front().time.front();
  log.start = {.x = first.x(), .y = first.y(), .heading = kVictoriaParkHeading};
  const fs::path manager = folder / "Sensors_manager.txt";
  if (fs::exists(manager)) check_manager(manager, log, steering);
  check_log(log, folder.string());
  return log;
}

}  // namespace montecarta::experiments
