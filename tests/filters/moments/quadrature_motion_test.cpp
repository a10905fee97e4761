// SPDX-License-Identifier: BSD-3-Clause
#include "filters/moments/motion_increment.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace montecarta::filters {
namespace {

TEST(QuadratureMotion, HasTheMomentsOfATremblingFrontAxle) {
  // (v + w)(cos(G + u), sin(G + u)) of normal w, u: E cos(G + u) = exp(-s^2 / 2) cos G.
  const Belief belief{.vehicle = {}, .control = {.sigma = {0.4, 0.07}}};
  const Control control{0.8, 0.3};
  const double duration = 0.1, s = belief.control.sigma[1];
  const double once = std::exp(-0.5 * s * s), twice = std::exp(-2.0 * s * s);
  const double square = control[0] * control[0] + belief.control.sigma[0] * belief.control.sigma[0];
  const Eigen::Vector2d mean =
      duration * control[0] * once * Eigen::Vector2d(std::cos(control[1]), std::sin(control[1]));
  const double c = twice * std::cos(2 * control[1]), d = twice * std::sin(2 * control[1]);
  Eigen::Matrix2d second;
  second << 0.5 * (1.0 + c), 0.5 * d, 0.5 * d, 0.5 * (1.0 - c);
  const Eigen::Matrix2d covariance =
      duration * duration * square * second - mean * mean.transpose();
  const MotionIncrement moved = moved_by_quadrature({}, control, duration, belief);
  // Three nodes err in the sixth power of the angle: 1e-9 of the step.
  EXPECT_NEAR(moved.pose().x, mean(0), 2e-10);
  EXPECT_NEAR(moved.pose().y, mean(1), 2e-10);
  EXPECT_NEAR(moved.pose().heading, mean(1) / std::get<Car>(belief.vehicle).wheelbase, 2e-10);
  const Eigen::Matrix3d found = symmetric(moved.covariance());
  EXPECT_LT((found.topLeftCorner<2, 2>() - covariance).norm(), 1e-9);
  EXPECT_NEAR(found(2, 2), covariance(1, 1) / std::pow(std::get<Car>(belief.vehicle).wheelbase, 2),
              1e-10);
  EXPECT_GT(covariance(1, 1), 1.2 * std::pow(duration * control[0] * s, 2))
      << "what a linearised step leaves out";
}

TEST(QuadratureMotion, IsTheLinearisedOneWhereNoiseIsSmall) {
  const Belief belief{.vehicle = {}, .control = {.sigma = {1e-4, 1e-5}}};
  MotionIncrement linear, averaged;
  for (int step = 0; step < 50; ++step) {
    linear.advance({3.0, 0.3}, 0.025, belief);
    averaged = moved_by_quadrature(averaged, {3.0, 0.3}, 0.025, belief);
  }
  EXPECT_LT(boxminus(averaged.pose(), linear.pose()).norm(), 1e-8);
  const Eigen::Matrix3d expected = symmetric(linear.covariance());
  EXPECT_LT((symmetric(averaged.covariance()) - expected).norm(), 1e-6 * expected.norm());
}

}  // namespace
}  // namespace montecarta::filters
