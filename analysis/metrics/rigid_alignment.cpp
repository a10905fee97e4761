// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/rigid_alignment.hpp"

#include "engine/errors.hpp"

#include <Eigen/Geometry>

#include <cmath>
#include <cstddef>

namespace montecarta::analysis {
namespace {

Eigen::Vector2d centre_of(std::span<const Eigen::Vector2d> points) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& point : points) sum += point;
  return sum / static_cast<double>(points.size());
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
  double along = 0.0, across = 0.0;  // sums of |a||b| cos and |a||b| sin of the angle from a to b
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Eigen::Vector2d a = from[i] - centre, b = onto[i] - target;
    along = std::fma(a.x(), b.x(), std::fma(a.y(), b.y(), along));
    across = std::fma(a.x(), b.y(), std::fma(-a.y(), b.x(), across));
  }
  motion.angle = std::atan2(across, along);
  motion.shift = target - Eigen::Rotation2Dd(motion.angle) * centre;
  return motion;
}

}  // namespace montecarta::analysis
