// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/recordings/mat_drive.hpp"

#include "engine/errors.hpp"
#include "experiments/recordings/drive_log.hpp"

#include <utility>

namespace montecarta::experiments {
namespace {

void check_count(const MatFile& file, const std::string& name, std::size_t found,
                 std::size_t count) {
  if (found == count) return;
  throw StudyError(file.place() + ": '" + name + "' has " + std::to_string(found) + " records of " +
                   std::to_string(count) +
                   " (as many as times are needed): take the file as published");
}

}  // namespace

std::vector<double> series_of(const MatFile& file, const std::string& name, std::size_t count) {
  std::vector<double> values = file.series(name);
  check_count(file, name, values.size(), count);
  return values;
}

std::vector<Odometry> odometry_of(const MatFile& file, const std::vector<double>& times,
                                  const std::string& speed, const std::string& steering) {
  const std::vector<double> speeds = series_of(file, speed, times.size());
  const std::vector<double> steers = series_of(file, steering, times.size());
  std::vector<Odometry> odometry(times.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    odometry[i] = {times[i], {speeds[i], steers[i]}};
  }
  check_odometry(odometry, controls_of(Car()), file.place());
  return odometry;
}

ReferencePath reference_of(const MatFile& file, const std::string& name, std::vector<double> times,
                           const std::string& east, const std::string& north) {
  const std::vector<double> x = series_of(file, east, times.size());
  const std::vector<double> y = series_of(file, north, times.size());
  ReferencePath reference{.name = name, .time = std::move(times), .position = {}, .heading = {}};
  for (std::size_t i = 0; i < x.size(); ++i) reference.position.emplace_back(x[i], y[i]);
  check_reference(reference, file.place());
  return reference;
}

SweepMatrix::SweepMatrix(const MatFile& file, const std::string& name)
    : values_(&file.matrix(name)) {
  if (static_cast<std::size_t>(values_->cols()) == kLaserBeams) return;
  throw StudyError(file.place() + ": '" + name + "' has " + std::to_string(values_->cols()) +
                   " columns (a sweep has 361 beams): take the file as published");
}

std::array<double, kLaserBeams> SweepMatrix::sweep(std::size_t scan) const {
  std::array<double, kLaserBeams> values;
  for (std::size_t beam = 0; beam < values.size(); ++beam) {
    values[beam] = (*values_)(static_cast<Eigen::Index>(scan), static_cast<Eigen::Index>(beam));
  }
  return values;
}

std::vector<LoggedScan> scans_of(const MatFile& file, const std::vector<double>& times,
                                 std::size_t sweeps,
                                 const std::function<std::vector<Detection>(std::size_t)>& detect) {
  check_count(file, "sweeps", sweeps, times.size());
  std::vector<LoggedScan> scans(times.size());
  for (std::size_t s = 0; s < scans.size(); ++s) scans[s] = {times[s], detect(s)};
  check_scans(scans, file.place());
  return scans;
}

std::string scan_place(const MatFile& file, std::size_t scan) {
  return file.place() + ": scan " + std::to_string(scan + 1);
}

}  // namespace montecarta::experiments
