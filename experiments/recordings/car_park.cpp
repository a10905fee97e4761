// SPDX-License-Identifier: BSD-3-Clause
#include "engine/errors.hpp"
#include "experiments/files/mat_file.hpp"
#include "experiments/recordings/drive_log.hpp"
#include "experiments/recordings/laser.hpp"
#include "experiments/recordings/mat_drive.hpp"
#include "experiments/recordings/published_drives.hpp"
#include "experiments/recordings/sensor_events.hpp"

#include <numbers>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

constexpr double kCarParkHeading = -125.5 * std::numbers::pi / 180.0;

std::vector<LoggedScan> scans_in(const MatFile& file, const std::vector<double>& times) {
  const SweepMatrix ranges(file, "Laser");
  const SweepMatrix intensities(file, "Intensity");
  if (intensities.scans() != ranges.scans()) {
    throw StudyError(file.place() + ": 'Laser' and 'Intensity' differ in scans (each echo has " +
                     "both): take the file as published");
  }
  return scans_of(file, times, ranges.scans(), [&](std::size_t s) {
    const auto sweep = ranges.sweep(s);
    const auto intensity = intensities.sweep(s);
    check_sweep(sweep, scan_place(file, s));
    check_sweep(intensity, scan_place(file, s) + " ('Intensity')");
    return detect_reflectors(sweep, intensity);
  });
}

std::vector<Eigen::Vector2d> poles_in(const fs::path& path) {
  const MatFile file(path);
  const Eigen::MatrixXd& poles = file.matrix("estbeac");
  if (poles.cols() != 2) {
    throw StudyError(path.string() + ": 'estbeac' has " + std::to_string(poles.cols()) +
                     " columns (a pole has East and North): take the file as published");
  }
  std::vector<Eigen::Vector2d> landmarks;
  for (Eigen::Index i = 0; i < poles.rows(); ++i) landmarks.emplace_back(poles.row(i).transpose());
  check_landmarks(landmarks, path.string());
  return landmarks;
}

}  // namespace

DriveLog read_car_park(const fs::path& folder) {
  const MatFile file(folder / "data_set.mat");
  const std::vector<double> wheel_times = file.series("Time_VS");
  const std::vector<double> laser_times = file.series("TimeLaser");
  DriveLog log;
  log.odometry = odometry_of(file, wheel_times, "Velocity", "Steering");
  log.scans = scans_in(file, laser_times);
  log.references = {reference_of(file, "gps", file.series("TimeGPS"), "GPSLon", "GPSLat")};
  const fs::path poles = folder / "beac_juan3.mat";
  if (fs::exists(poles)) log.landmarks = poles_in(poles);
  const Eigen::Vector2d& first = log.references.front().position.front();
  log.start_time = log.references.front().time.front();
  log.start = {.x = first.x(), .y = first.y(), .heading = kCarParkHeading};
  check_events({file.series("Time"), file.series("Sensor"), file.series("Index")},
               {log.references.front().time, wheel_times, laser_times}, file.place());
  check_log(log, folder.string());
  return log;
}

}  // namespace montecarta::experiments
