// SPDX-License-Identifier: BSD-3-Clause
// What is stored of recorded drives: references, and where every run is a drive of its own its
// times (analysis/FORMAT.md).
#include "engine/records/h5.hpp"
#include "engine/records/read_numbers.hpp"
#include "engine/records/result_layout.hpp"

#include <algorithm>
#include <span>
#include <string>
#include <utility>

namespace montecarta::engine {
namespace {

constexpr std::size_t kDigits = 5;  // of the number of a drive

/// "drive_00012": by name in the order of the runs.
std::string drive_name(std::size_t run) {
  const std::string number = std::to_string(run);
  return "drive_" + std::string(kDigits - std::min(kDigits, number.size()), '0') + number;
}

/// Of every fix the block of the components that it measures, row by row.
std::vector<double> covariance_rows(const ReferencePath& path) {
  const int d = path.dimension();
  std::vector<double> rows;
  for (const Eigen::Matrix3d& covariance : path.covariance) {
    for (int i = 0; i < d; ++i) {
      for (int j = 0; j < d; ++j) rows.push_back(covariance(i, j));
    }
  }
  return rows;
}

void add_covariance(const h5::Handle& group, const ReferencePath& path, const Scales& scales) {
  if (path.covariance.empty()) return;
  const bool headed = path.dimension() == 3;
  const std::string axis = headed ? "component" : "coordinate";
  const auto side = static_cast<std::uint64_t>(path.dimension());
  const auto dataset =
      add_dataset(group, "covariance", Element::f64, {path.covariance.size(), side, side},
                  {"fix", axis, axis + "_column"},
                  {headed ? "(m, m, rad)^2" : "m2", "covariance of the error of the fix"}, scales);
  h5::write(dataset, Element::f64, covariance_rows(path).data());
}

void add_reference(const h5::Handle& references, const ReferencePath& path, Scales& scales) {
  const h5::Handle group = h5::create_group(references, path.name);
  add_scale(group, "fix", path.time, {"s", "time of the fix"}, scales);
  const auto position =
      add_dataset(group, "position", Element::f64, {path.position.size(), 2}, {"fix", "coordinate"},
                  {"m", "measured position of the vehicle"}, scales);
  h5::write(position, Element::f64, path.position.data());
  add_covariance(group, path, scales);
  if (path.heading.empty()) return;
  const auto heading = add_dataset(group, "heading", Element::f64, {path.heading.size()}, {"fix"},
                                   {"rad", "measured heading of the vehicle"}, scales);
  h5::write(heading, Element::f64, path.heading.data());
}

/// {fix}; as many as there are whole blocks of `dimension` x `dimension` numbers.
std::vector<Eigen::Matrix3d> read_covariances(const h5::Handle& group, int dimension) {
  std::vector<Eigen::Matrix3d> covariances;
  if (!h5::has(group, "covariance")) return covariances;
  const auto numbers = read_all<double>(group, "covariance", Element::f64);
  const auto block = static_cast<std::size_t>(dimension) * static_cast<std::size_t>(dimension);
  for (std::size_t first = 0; first + block <= numbers.size(); first += block) {
    covariances.emplace_back(Eigen::Matrix3d::Zero());
    covariances.back().topLeftCorner(dimension, dimension) =
        Eigen::Map<const Eigen::MatrixXd>(numbers.data() + first, dimension, dimension);
  }
  return covariances;
}

void add_own_drive(const h5::Handle& drives, const std::string& name, const OwnDrive& drive,
                   Scales& scales) {
  static_assert(sizeof(Pose) == 3 * sizeof(double));
  const h5::Handle group = h5::create_group(drives, name);
  const auto start = add_dataset(group, "start", Element::f64, {3}, {"component"},
                                 {"m, m, rad", "pose before the first step"}, scales);
  h5::write(start, Element::f64, &drive.start);
  add_scale(group, "scan_time", drive.scan_times, {"s", "time of the scan"}, scales);
  const auto steps =
      add_dataset(group, "scan_step", Element::u32, {drive.scan_steps.size()}, {"scan_time"},
                  {"1", "control step after which the scan is taken"}, scales);
  h5::write(steps, Element::u32, drive.scan_steps.data());
  add_references(group, drive.references, scales);
}

}  // namespace

void add_references(const h5::Handle& scenario, const std::vector<ReferencePath>& references,
                    Scales& scales) {
  if (references.empty()) return;
  const h5::Handle group = h5::create_group(scenario, format::kReferences);
  for (const ReferencePath& path : references) add_reference(group, path, scales);
}

void add_own_drives(const h5::Handle& scenario, const std::vector<OwnDrive>& drives,
                    Scales& scales) {
  if (drives.empty()) return;
  const h5::Handle group = h5::create_group(scenario, format::kDrives);
  for (std::size_t run = 0; run < drives.size(); ++run)
    add_own_drive(group, drive_name(run), drives[run], scales);
}

std::vector<ReferencePath> read_references(const h5::Handle& scenario) {
  std::vector<ReferencePath> all;
  if (!h5::has(scenario, format::kReferences)) return all;
  const h5::Handle references = h5::open_group(scenario, format::kReferences);
  for (const std::string& name : h5::members(references)) {
    const h5::Handle group = h5::open_group(references, name);
    ReferencePath path{name, read_all<double>(group, "fix", Element::f64), {}, {}};
    for (const auto& [x, y] : read_points(group, "position")) path.position.emplace_back(x, y);
    if (h5::has(group, "heading")) path.heading = read_all<double>(group, "heading", Element::f64);
    path.covariance = read_covariances(group, path.dimension());
    all.push_back(std::move(path));
  }
  return all;
}

std::vector<OwnDrive> read_own_drives(const h5::Handle& scenario) {
  std::vector<OwnDrive> all;
  if (!h5::has(scenario, format::kDrives)) return all;
  const h5::Handle drives = h5::open_group(scenario, format::kDrives);
  const std::size_t count = h5::members(drives).size();
  for (std::size_t run = 0; run < count; ++run) {
    const h5::Handle group = h5::open_group(drives, drive_name(run));
    OwnDrive& drive = all.emplace_back();
    h5::read(h5::open_dataset(group, "start"), Element::f64,
             std::as_writable_bytes(std::span(&drive.start, 1)));
    drive.scan_times = read_all<double>(group, "scan_time", Element::f64);
    drive.scan_steps = read_all<std::uint32_t>(group, "scan_step", Element::u32);
    drive.references = read_references(group);
  }
  return all;
}

}  // namespace montecarta::engine
