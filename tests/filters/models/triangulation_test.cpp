// SPDX-License-Identifier: BSD-3-Clause
#include "filters/models/triangulation.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <limits>

namespace montecarta::models {
namespace {

/// Standard deviations of 1 m and 0.5 m along axes that no axis of the map is parallel to.
Eigen::Matrix2d oblique_covariance() {
  const Eigen::Matrix2d axes = Eigen::Rotation2Dd(0.5).toRotationMatrix();
  return axes * Eigen::Vector2d(1.0, 0.25).asDiagonal() * axes.transpose();
}

TEST(CrossesWell, WhereTheLongestAxisIsShortBesideTheDistance) {
  constexpr bool kOfBearings = true;
  EXPECT_TRUE(crosses_well(oblique_covariance(), 10.001, kOfBearings, 1e-4));
  EXPECT_FALSE(crosses_well(oblique_covariance(), 9.999, kOfBearings, 1e-4));
}

TEST(CrossesWell, OfRangesWhereTheCurvatureIsSmallBesideTheNoise) {
  constexpr bool kOfBearings = false;
  // 1 / (2 * 20) m across changes a range by 0.025 m, a quarter of 0.1 m.
  EXPECT_TRUE(crosses_well(oblique_covariance(), 20.001, kOfBearings, 0.01));
  EXPECT_FALSE(crosses_well(oblique_covariance(), 19.999, kOfBearings, 0.01));
}

TEST(CrossesWell, NeverWithoutANumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(crosses_well(Eigen::Matrix2d::Constant(nan), 10.0, true, 1e-4));
}

}  // namespace
}  // namespace montecarta::models
