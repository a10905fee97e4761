// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/joint_gaussian.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <cmath>

namespace montecarta::filters {
namespace {

/// A pose that knows neither its place nor its heading well, and a landmark seen from there.
JointGaussian uncertain(double heading_deviation) {
  JointGaussian gaussian({}, Retraction::additive, 1);
  gaussian.start({1.0, 2.0, 0.5});
  gaussian.move(
      MotionIncrement(Pose{}, {.xx = 0.3, .yy = 0.2, .hh = heading_deviation * heading_deviation}));
  gaussian.append(Eigen::Vector2d(5.0, 0.4));
  gaussian.move(MotionIncrement(Pose{2.0, 0.5, 0.3}, {.xx = 0.1, .yy = 0.2, .hh = 0.01}));
  return gaussian;
}

TEST(Regression, OfAMotionHasTheMomentsOfATurnedWay) {
  const double sigma = 0.3, kept = std::exp(-0.5 * sigma * sigma);
  JointGaussian gaussian({}, Retraction::additive, 1);
  gaussian.start({});
  gaussian.move(MotionIncrement(Pose{}, {.hh = sigma * sigma}));
  const MotionIncrement way(Pose{4.0, 0.0, 0.0}, {});
  const PoseMoments moved = gaussian.pose_after(gaussian.regressed(way));
  // Of (4 cos a, 4 sin a), a ~ N(0, sigma^2); the sigma points err by sigma^6 of relative size.
  EXPECT_NEAR(moved.mean.x, 4.0 * kept, 1e-4);
  EXPECT_NEAR(moved.covariance(1, 2), 4.0 * kept * sigma * sigma, 2e-3);
  EXPECT_NEAR(moved.covariance(1, 1), 8.0 * (1.0 - std::pow(kept, 4)), 0.02);
  EXPECT_NEAR(moved.covariance(0, 0), 8.0 * std::pow(1.0 - kept * kept, 2), 0.02);
  EXPECT_GT(moved.covariance(0, 0), 0.04);  // linearised it is 0
}

TEST(Regression, OfAnObservationIsTheDerivativeWhereNoiseIsSmall) {
  Belief belief{.vehicle = {}, .control = {}, .sigma_range = 1e-5, .sigma_bearing = 1e-6};
  JointGaussian gaussian(belief, Retraction::additive, 1);
  gaussian.start({1.0, 2.0, 0.5});
  gaussian.append(Eigen::Vector2d(5.0, 0.4));
  gaussian.move(MotionIncrement(Pose{2.0, 0.5, 0.3}, {.xx = 1e-10, .yy = 1e-10, .hh = 1e-10}));
  ExpectedObservation derived, regressed;
  ASSERT_EQ(gaussian.look_at(0, derived), JointGaussian::Trouble::none);
  ASSERT_EQ(gaussian.look_by_sigma_points(gaussian.point(0), regressed),
            JointGaussian::Trouble::none);
  EXPECT_LT((regressed.pose_jacobian - derived.pose_jacobian).norm(), 1e-6);
  EXPECT_LT((regressed.landmark_jacobian - derived.landmark_jacobian).norm(), 1e-6);
  EXPECT_LT((regressed.observation - derived.observation).norm(), 1e-8);
}

TEST(Regression, ExpectsALongerRangeAndMoreNoiseThanTheDerivative) {
  const JointGaussian gaussian = uncertain(0.2);
  ExpectedObservation derived, regressed;
  ASSERT_EQ(gaussian.look_at(0, derived), JointGaussian::Trouble::none);
  ASSERT_EQ(gaussian.look_by_sigma_points(gaussian.point(0), regressed),
            JointGaussian::Trouble::none);
  const PointMoments at = gaussian.point(0);
  const Pose& pose = gaussian.pose().mean;
  const Eigen::Vector2d away = at.mean - Eigen::Vector2d(pose.x, pose.y);
  const Eigen::Matrix2d mixed = at.cross.leftCols<2>();
  const Eigen::Matrix2d relative =
      at.covariance + gaussian.pose().covariance.topLeftCorner<2, 2>() - mixed - mixed.transpose();
  const Eigen::Vector2d across = quarter_turn() * away.normalized();
  const double variance = across.dot(relative * across);
  // Second order: the range is longer by variance / 2 r, the rest is of fourth order.
  const double longer = 0.5 * variance / away.norm();
  EXPECT_NEAR(regressed.observation(0) - derived.observation(0), longer, 0.2 * longer);
  EXPECT_GT(regressed.factor.covariance()(0, 0), derived.factor.covariance()(0, 0));
}

}  // namespace
}  // namespace montecarta::filters
