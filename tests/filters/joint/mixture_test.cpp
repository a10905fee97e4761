// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/mixture.hpp"

#include "engine/numbers/angle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace montecarta::filters {
namespace {

JointEstimate gaussian(double x, double heading, double variance) {
  JointEstimate joint{Eigen::VectorXd(5), variance * Eigen::MatrixXd::Identity(5, 5)};
  joint.mean << x, 2.0, heading, 10.0 * x, 1.0;
  joint.covariance(0, 3) = joint.covariance(3, 0) = 0.3 * variance;
  return joint;
}

TEST(MixtureOfJoints, HasTheMomentsOfItsComponents) {
  Mixture mixture(gaussian(1.0, 0.1, 0.5));
  mixture.add(0.25, gaussian(1.0, 0.1, 0.5));
  mixture.add(0.75, gaussian(3.0, -0.1, 0.1));
  const JointEstimate whole = mixture.result();
  EXPECT_NEAR(whole.mean(0), 2.5, 1e-12);
  EXPECT_NEAR(whole.mean(2), -0.05, 1e-12);
  EXPECT_NEAR(whole.mean(3), 25.0, 1e-12);
  const double own = 0.25 * 0.5 + 0.75 * 0.1, between = 0.25 * 0.75;
  EXPECT_NEAR(whole.covariance(0, 0), own + between * 4.0, 1e-12);
  EXPECT_NEAR(whole.covariance(0, 3), 0.3 * own + between * 2.0 * 20.0, 1e-12);
  EXPECT_NEAR(whole.covariance(2, 3), between * -0.2 * 20.0, 1e-12);
  EXPECT_NEAR(whole.covariance(1, 1), own, 1e-12);
}

TEST(MixtureOfJoints, TurnsTheShorterWay) {
  Mixture mixture(gaussian(0.0, 3.1, 0.1));
  mixture.add(0.25, gaussian(0.0, 3.1, 0.1));
  mixture.add(0.75, gaussian(0.0, -3.1, 0.1));
  const double between = 2.0 * (kPi - 3.1);
  const JointEstimate whole = mixture.result();
  EXPECT_NEAR(whole.mean(2), -3.1 - 0.25 * between, 1e-12);
  EXPECT_NEAR(whole.covariance(2, 2), 0.1 + 0.25 * 0.75 * between * between, 1e-12);
}

TEST(MixtureOfJoints, OfEqualsIsOneOfThem) {
  const JointEstimate one = gaussian(1.0 / 3.0, 0.7, 0.1);
  Mixture mixture(one);
  for (int i = 0; i < 3; ++i) mixture.add(1.0 / 3.0, one);
  EXPECT_EQ(mixture.result().mean, one.mean);
  EXPECT_EQ(mixture.result().covariance, one.covariance);
}

TEST(MixtureOfJoints, KnowsNothingOfWhatNoneHasSeen) {
  JointEstimate one = gaussian(1.0, 0.0, 0.1);
  one.mean.tail<2>().setConstant(std::numeric_limits<double>::quiet_NaN());
  Mixture mixture(one);
  mixture.add(1.0, one);
  EXPECT_TRUE(std::isnan(mixture.result().mean(4)));
  EXPECT_EQ(mixture.result().mean(0), 1.0);
}

TEST(MixtureOfPoses, HasTheMomentsOfItsComponentsTheShorterWay) {
  const PoseMoments one{{1.0, 2.0, 3.1}, 0.5 * Eigen::Matrix3d::Identity()};
  const PoseMoments other{{3.0, 2.0, -3.1}, 0.1 * Eigen::Matrix3d::Identity()};
  Mixture mixture(one);
  mixture.add(0.25, one);
  mixture.add(0.75, other);
  const auto [mean, covariance] = mixture.result();
  const double own = 0.25 * 0.5 + 0.75 * 0.1, between = 0.25 * 0.75, turn = 2.0 * (kPi - 3.1);
  EXPECT_NEAR(mean.x, 2.5, 1e-12);
  EXPECT_EQ(mean.y, 2.0);
  EXPECT_NEAR(mean.heading, -3.1 - 0.25 * turn, 1e-12);
  EXPECT_NEAR(covariance(0, 0), own + between * 4.0, 1e-12);
  EXPECT_NEAR(covariance(0, 2), between * 2.0 * turn, 1e-12);
  EXPECT_NEAR(covariance(2, 2), own + between * turn * turn, 1e-12);
}

TEST(MixtureOfLandmarks, HasTheMomentsOfItsComponents) {
  const LandmarkEstimate one{{1.0, 2.0}, 0.5 * Eigen::Matrix2d::Identity()};
  const LandmarkEstimate other{{3.0, 2.0}, 0.1 * Eigen::Matrix2d::Identity()};
  Mixture mixture(one);
  mixture.add(0.25, one);
  mixture.add(0.75, other);
  const LandmarkEstimate whole = mixture.result();
  EXPECT_NEAR(whole.mean.x(), 2.5, 1e-12);
  EXPECT_NEAR(whole.covariance(0, 0), 0.25 * 0.5 + 0.75 * 0.1 + 0.25 * 0.75 * 4.0, 1e-12);
  EXPECT_NEAR(whole.covariance(1, 1), 0.25 * 0.5 + 0.75 * 0.1, 1e-12);
}

}  // namespace
}  // namespace montecarta::filters
