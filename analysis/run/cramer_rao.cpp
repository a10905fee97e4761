// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/cramer_rao.hpp"

#include "analysis/run/joint_bound.hpp"
#include "analysis/run/run_reader.hpp"
#include "analysis/run/simulated_world.hpp"
#include "engine/core/drive.hpp"
#include "filters/models/ackermann.hpp"
#include "filters/models/field_of_view.hpp"
#include "filters/models/range_bearing.hpp"
#include "filters/models/vehicle.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <span>

namespace montecarta::analysis {
namespace {

using Complex = std::complex<double>;

/// The step in the vehicle's frame that leads from one pose to another if it is taken `steps`
/// times. Since every step also turns, it advances by the sum of exp(i k turn).
BodyStep<double> equal_steps(const Pose& from, const Pose& to, std::size_t steps) {
  const Eigen::Vector3d change = boxminus(to, from);
  const double turn = change(2) / static_cast<double>(steps);
  Complex advance = 0.0;
  for (std::size_t k = 0; k < steps; ++k) {
    advance += std::polar(1.0, turn * static_cast<double>(k));
  }
  const Complex step = std::polar(1.0, -from.heading) * Complex(change(0), change(1)) / advance;
  return {step.real(), step.imag(), turn};
}

void move_along(const TruePath& path, std::size_t row, const Vehicle& vehicle, JointBound& bound) {
  Pose pose = row == 0 ? path.start : path.rows[row - 1];
  const BodyStep<double> step = equal_steps(pose, path.rows[row], path.steps[row]);
  const Control control = control_of(step, path.durations[row], vehicle);
  for (std::size_t k = 0; k < path.steps[row]; ++k) {
    pose = bound.move(pose, control, path.durations[row]);
  }
}

std::vector<JointBound::SeenLandmark> seen_from(const Pose& pose, const SimulatedWorld& world,
                                                std::span<const Eigen::Vector2d> landmarks) {
  std::vector<JointBound::SeenLandmark> seen;
  world.view.look(pose, landmarks, [&](const InView& one) {
    if (one.range < kLeastDistance) return;  // the range has no derivative
    const Eigen::Vector2d& at = landmarks[one.landmark];
    seen.push_back({one.landmark, {at.x(), at.y()}});
  });
  return seen;
}

/// Returns the path without its poses: times and numbers of control steps of its rows. A row is a
/// scan if the file stores scans only, else a step.
TruePath steps_of(const ResultFile& file) {
  TruePath path{file.description().start, {}, {}, {}, {}, file.scan_rows()};
  const std::vector<double>& times = file.times();
  const bool scans_only = times.size() == file.scan_times().size();
  const std::vector<std::uint32_t>& scan_steps = file.description().scan_steps;
  for (std::size_t r = 0; r < times.size(); ++r) {
    const std::size_t steps = !scans_only ? 1
                              : r == 0    ? scan_steps[0] + 1
                                          : scan_steps[r] - scan_steps[r - 1];
    path.steps.push_back(steps);
    path.durations.push_back((times[r] - (r == 0 ? 0.0 : times[r - 1])) /
                             static_cast<double>(steps));
  }
  return path;
}

void read_rows(const ResultFile& file, std::size_t run, TruePath& path) {
  path.landmarks = file.landmarks_of(run);
  std::vector<double> truth(3 * file.times().size());
  file.read_truth(run, truth);
  for (std::size_t r = 0; r < file.times().size(); ++r) {
    path.rows.push_back({truth[3 * r], truth[3 * r + 1], truth[3 * r + 2]});
  }
}

/// Indices of the first runs that have a path, at most `wanted`.
std::vector<std::size_t> first_runs(const ResultFile& file, std::size_t wanted) {
  std::vector<bool> complete(file.runs().size());
  for (const StoredCell& cell : file.cells()) {
    const std::vector<RunStatus> status = file.status(cell);
    for (std::size_t i = 0; i < status.size(); ++i) {
      if (status[i] == RunStatus::complete) complete[i] = true;
    }
  }
  std::vector<std::size_t> runs;
  for (std::size_t i = 0; i < complete.size() && runs.size() < wanted; ++i) {
    if (complete[i]) runs.push_back(i);
  }
  return runs;
}

void add(const std::vector<double>& values, std::vector<double>& sums) {
  sums.resize(values.size());
  for (std::size_t s = 0; s < sums.size(); ++s) sums[s] += values[s];
}

/// The root of the mean of `squares`, added in the order of the runs.
CramerRaoBound root_mean(const std::vector<CramerRaoBound>& squares) {
  CramerRaoBound bound;
  bound.runs = squares.size();
  bound.map = 0.0;
  for (const CramerRaoBound& one : squares) {
    if (!one.missing.empty()) return one;
    add(one.position, bound.position);
    add(one.heading, bound.heading);
    bound.map += one.map;
  }
  const auto finish = [&](double& sum) { sum = std::sqrt(sum / static_cast<double>(bound.runs)); };
  std::ranges::for_each(bound.position, finish);
  std::ranges::for_each(bound.heading, finish);
  finish(bound.map);
  return bound;
}

CramerRaoBound none_for(const std::string& reason) {
  CramerRaoBound bound;
  bound.missing = reason;
  return bound;
}

}  // namespace

CramerRaoBound squared_bound(const SimulatedWorld& world, const TruePath& path) {
  // The information of a detection that may be missed counts with the probability of the detection.
  const Eigen::Vector2d observation_variance = world.sigma_observation.cwiseAbs2() / world.detected;
  JointBound joint(path.landmarks.size(), world.vehicle, world.control_noise, observation_variance,
                   world.sensor);
  if (world.prior) joint.start_from(*world.prior);
  CramerRaoBound bound;
  std::size_t row = 0;
  for (const std::uint32_t scan_row : path.scan_rows) {
    for (; row <= scan_row; ++row) move_along(path, row, world.vehicle, joint);
    const Pose& pose = path.rows[scan_row];
    const std::size_t scan = bound.position.size() + 1;
    const bool has_fix = world.scans_per_fix > 0 && scan % world.scans_per_fix == 0;
    if (has_fix && !joint.fix(world.sigma_fix * world.sigma_fix)) {
      return none_for("the noise of the fixes is too small to compute with");
    }
    if (world.detected > 0.0 && !joint.scan(pose, seen_from(pose, world, path.landmarks))) {
      return none_for("the noise is too small to compute with");
    }
    bound.position.push_back(joint.pose()(0, 0) + joint.pose()(1, 1));
    bound.heading.push_back(joint.pose()(2, 2));
  }
  const bool is_exact = world.prior && world.prior->landmark == 0.0;
  if (!is_exact) bound.map = joint.mean_map_variance();
  bound.runs = 1;
  return bound;
}

BoundOfStudy::BoundOfStudy(const ResultFile& file)
    : world_(simulated_world_of(file)),
      first_judged_(static_cast<std::ptrdiff_t>(judged_scans_of(file).first)) {
  if (!world_) {
    missing_ = "the file does not describe a simulated vehicle and its sensor";
  } else if (!(world_->sigma_observation.minCoeff() > 0.0)) {
    missing_ = "the sensor has no noise";
  } else {
    const bool same = world_->same_path && !file.has_own_landmarks();
    for (const std::size_t run : first_runs(file, same ? 1 : kBoundRuns)) {
      read_rows(file, run, paths_.emplace_back(steps_of(file)));
    }
    if (paths_.empty()) missing_ = "no run is complete";
  }
  squares_.resize(paths_.size());
}

CramerRaoBound BoundOfStudy::result() const {
  if (!missing_.empty()) return none_for(missing_);
  CramerRaoBound bound = root_mean(squares_);
  bound.is_bound = world_->same_path;
  for (auto* const series : {&bound.position, &bound.heading}) {
    if (!series->empty()) series->erase(series->begin(), series->begin() + first_judged_);
  }
  return bound;
}

}  // namespace montecarta::analysis
