// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/reference_scores.hpp"

#include "engine/errors.hpp"

#include <Eigen/Geometry>

#include <cstddef>

namespace montecarta::analysis {
namespace {

Eigen::Vector2d centre_of(std::span<const Eigen::Vector2d> points) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

using Points = std::vector<Eigen::Vector2d>;

/// Summary of the distances over fixes [m].
struct Distances {
  double rms, median, gated_rms, gated_share;
};

double root_mean(double sum, std::size_t n) { return std::sqrt(sum / static_cast<double>(n)); }

Distances in_numbers(const std::vector<double>& squared) {
  const double median = std::sqrt(median_of(squared));
  const double gate = kReferenceGate * median;
  double all = 0.0, within = 0.0;
  std::size_t n = 0;
  for (const double square : squared) {
    all += square;
    if (!(square <= gate * gate)) continue;
    within += square;
    ++n;
  }
  return {root_mean(all, squared.size()), median, root_mean(within, n),
          static_cast<double>(n) / static_cast<double>(squared.size())};
}

std::vector<double> squared_distances(const Points& estimate, const Points& fixes) {
  std::vector<double> squared;
  for (std::size_t f = 0; f < fixes.size(); ++f) {
    squared.push_back((estimate[f] - fixes[f]).squaredNorm());
  }
  return squared;
}

Points positions_of(const std::vector<Pose>& poses) {
  Points points;
  for (const Pose& pose : poses) points.emplace_back(pose.x, pose.y);
  return points;
}

Points moved_by(const RigidMotion& motion, const Points& estimate) {
  Points moved;
  for (const Eigen::Vector2d& point : estimate) moved.push_back(motion(point));
  return moved;
}

double heading_rmse(const std::vector<Pose>& poses, const std::vector<double>& headings) {
  double sum = 0.0;
  for (std::size_t f = 0; f < headings.size(); ++f) {
    const double error = boxminus({0.0, 0.0, headings[f]}, poses[f])(2);
    sum += error * error;
  }
  return root_mean(sum, headings.size());  // NaN without headings
}

}  // namespace

Eigen::Vector2d RigidMotion::operator()(const Eigen::Vector2d& point) const {
  return Eigen::Rotation2Dd(angle) * point + shift;
}

RigidMotion rigid_alignment(std::span<const Eigen::Vector2d> from,
                            std::span<const Eigen::Vector2d> onto) {
  expect(from.size() == onto.size(), "points are aligned in pairs");
  RigidMotion motion;
  if (from.empty()) return motion;
  const Eigen::Vector2d centre = centre_of(from), target = centre_of(onto);
  // Sums over pairs of |a||b| cos and |a||b| sin of the angle from a to b.
  double along = 0.0, across = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Eigen::Vector2d a = from[i] - centre, b = onto[i] - target;
    along = std::fma(a.x(), b.x(), std::fma(a.y(), b.y(), along));
    across = std::fma(a.x(), b.y(), std::fma(-a.y(), b.x(), across));
  }
  motion.angle = std::atan2(across, along);
  motion.shift = target - Eigen::Rotation2Dd(motion.angle) * centre;
  return motion;
}

ReferenceRun measure_against(const PathAtFixes& fixes, std::span<const double> path) {
  const std::vector<Pose> poses = fixes.interpolate(path);
  const Points estimate = positions_of(poses);
  ReferenceRun run;
  if (poses.empty()) return run;
  run.squared_error = squared_distances(estimate, fixes.positions());
  const Distances raw = in_numbers(run.squared_error);
  run.alignment = rigid_alignment(estimate, fixes.positions());
  const Distances fitted =
      in_numbers(squared_distances(moved_by(run.alignment, estimate), fixes.positions()));
  run.scores = {raw.rms,          raw.median,         raw.gated_rms,
                raw.gated_share,  fitted.rms,         fitted.median,
                fitted.gated_rms, fitted.gated_share, heading_rmse(poses, fixes.headings())};
  return run;
}

}  // namespace montecarta::analysis
