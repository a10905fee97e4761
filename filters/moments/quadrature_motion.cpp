// SPDX-License-Identifier: BSD-3-Clause
#include "filters/moments/quadrature_motion.hpp"

#include <array>
#include <cmath>
#include <utility>

namespace montecarta {
namespace {

/// Of a standard normal: exact for polynomials of degree 5.
constexpr std::array<std::pair<double, double>, 3> kNodesAndWeights{
    {{0.0, 2.0 / 3.0}, {1.7320508075688773, 1.0 / 6.0}, {-1.7320508075688773, 1.0 / 6.0}}};

/// Displacement (forward, left, turn) in the frame of the vehicle before the step.
struct BodyMoments {
  Eigen::Vector3d mean;
  Eigen::Matrix3d covariance;
};

BodyMoments body_moments(const Control& control, double duration, const Belief& belief) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();    // at 1 m/s
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();  // likewise, about the origin
  for (const auto& [node, weight] : kNodesAndWeights) {
    const auto step =
        body_step(belief.vehicle, 1.0, control.steer + node * belief.sigma_steer, duration);
    const Eigen::Vector3d way(step.forward, step.left, step.turn);
    mean += weight * way;
    second += weight * way * way.transpose();
  }
  const double square = control.speed * control.speed;
  return {control.speed * mean, (square + belief.sigma_speed * belief.sigma_speed) * second -
                                    square * mean * mean.transpose()};
}

}  // namespace

MotionIncrement moved_by_quadrature(const MotionIncrement& before, const Control& control,
                                    double duration, const Belief& belief) {
  const auto [way, noise] = body_moments(control, duration, belief);
  const Pose& from = before.pose();
  const Direction<double> course = direction_of(from.heading);
  const Point moved = in_world(course, way(0), way(1));
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() << course.cosine, -course.sine, course.sine, course.cosine;
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
  F(0, 2) = -moved.y;
  F(1, 2) = moved.x;
  return {{from.x + moved.x, from.y + moved.y, wrap(from.heading + way(2))},
          F * before.covariance() * F.transpose() + turn * noise * turn.transpose()};
}

}  // namespace montecarta
