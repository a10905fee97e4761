// SPDX-License-Identifier: BSD-3-Clause
#include "filters/moments/motion_increment.hpp"

#include <array>
#include <cmath>
#include <span>

namespace montecarta::filters {
namespace {

/// Of a standard normal: exact for polynomials of degree 5.
constexpr std::array<double, 3> kNodes{0.0, 1.7320508075688773, -1.7320508075688773};
constexpr std::array<double, 3> kWeights{2.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0};

/// Displacement (forward, left, turn) in the frame of the vehicle before the step.
struct BodyMoments {
  Column3<double> mean;
  Symmetric3<double> covariance;
};

/// `wheels`: the directions of the nodes' steering angles.
BodyMoments body_moments(std::span<const Direction<double>> wheels, double speed, double duration,
                         const Belief& belief) {
  Column3<double> mean{0.0, 0.0, 0.0};  // at 1 m/s
  Symmetric3<double> second;            // likewise, about the origin
  for (std::size_t k = 0; k < kNodes.size(); ++k) {
    const auto step = body_step(belief.vehicle, 1.0, wheels[k], duration);
    const Column3<double> way{step.forward, step.left, step.turn};
    mean = mean + kWeights[k] * way;
    add_outer(second, kWeights[k], way);
  }
  const double square = speed * speed;
  Symmetric3<double> covariance = (square + belief.sigma_speed * belief.sigma_speed) * second;
  add_outer(covariance, -square, mean);
  return {speed * mean, covariance};
}

}  // namespace

MotionIncrement moved_by_quadrature(const MotionIncrement& before, const Control& control,
                                    double duration, const Belief& belief) {
  const Pose& from = before.pose();
  const auto angle = [&](std::size_t k) { return control.steer + kNodes[k] * belief.sigma_steer; };
  const auto directions = directions_of<4>({angle(0), angle(1), angle(2), from.heading});
  const Direction<double>& course = directions.back();
  const auto [way, noise] =
      body_moments(std::span(directions).first(3), control.speed, duration, belief);
  const Point moved = in_world(course, way.x, way.y);
  return {{from.x + moved.x, from.y + moved.y, wrap(from.heading + way.h)},
          sheared(before.covariance(), -moved.y, moved.x) + turned(noise, course)};
}

}  // namespace montecarta::filters
