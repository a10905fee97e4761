// SPDX-License-Identifier: BSD-3-Clause
#include "filters/models/triangulation.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <limits>
#include <vector>

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

constexpr double kVariance = 1e-4;
const Point kLandmark{12.0, 9.0};
const Pose kFirst{1.0, 2.0, 0.3}, kSecond{6.0, -1.0, -0.4}, kThird{-2.0, 7.0, 1.0};

Sighting seen_from(const Sensor& sensor, const Pose& pose) {
  return {pose, linearised_detection(sensor, pose, kLandmark)->value(0)};
}

std::vector<Sensor> sensors_of_one_component() {
  return {{BearingSensor(), {}}, {RangeSensor(), {}}};
}

/// The side of the way from the first pose to the second on which the landmark lies.
constexpr double kSide = 1.0;

TEST(TwoSightings, CrossInTheLandmarkWithTheCovarianceOfTheirNoise) {
  for (const Sensor& sensor : sensors_of_one_component()) {
    const TwoSightings sightings(sensor, kVariance);
    const Sighting first = seen_from(sensor, kFirst), second = seen_from(sensor, kSecond);
    const auto at = sightings.crossing(first, second, kSide);
    ASSERT_TRUE(at) << name_of(sensor);
    EXPECT_LT((at->point - to_vector(kLandmark)).norm(), 1e-9) << name_of(sensor);
    const auto moved = [&](double a, double b) {
      return sightings.crossing({kFirst, first.value + a}, {kSecond, second.value + b}, kSide)
          ->point;
    };
    constexpr double h = 1e-5;
    Eigen::Matrix2d J;
    J << (moved(h, 0) - moved(-h, 0)) / (2 * h), (moved(0, h) - moved(0, -h)) / (2 * h);
    const Eigen::Matrix2d expected = kVariance * J * J.transpose();
    EXPECT_LT((at->covariance - expected).norm(), 1e-6 * expected.norm()) << name_of(sensor);
  }
}

TEST(TwoSightings, CrossWellFromPosesThatAreFarApart) {
  for (const Sensor& sensor : sensors_of_one_component()) {
    const TwoSightings sightings(sensor, kVariance);
    const Sighting first = seen_from(sensor, kFirst);
    EXPECT_TRUE(sightings.cross_well(first, seen_from(sensor, kSecond))) << name_of(sensor);
    EXPECT_FALSE(sightings.cross_well(first, seen_from(sensor, {1.05, 2.0, 0.3})))
        << name_of(sensor);
  }
}

TEST(TwoSightings, AThirdRangeTellsTheSide) {
  const Sensor sensor{RangeSensor(), {}};
  const TwoSightings sightings(sensor, kVariance);
  const Sighting first = seen_from(sensor, kFirst), second = seen_from(sensor, kSecond);
  Sighting third = seen_from(sensor, kThird);
  EXPECT_NEAR(sightings.squared_distance(first, second, kSide, third), 0.0, 1e-12);
  EXPECT_GT(sightings.squared_distance(first, second, -kSide, third), 1000.0);
  third.value += 0.1;
  const auto at = sightings.crossing(first, second, kSide);
  const Eigen::RowVector2d H = linearised_detection(sensor, kThird, kLandmark)->by_landmark.row(0);
  EXPECT_NEAR(sightings.squared_distance(first, second, kSide, third),
              0.01 / ((H * at->covariance * H.transpose()).value() + kVariance), 1e-6);
}

TEST(TwoSightings, DoNotCrossBehind) {
  const TwoSightings sightings({BearingSensor(), {}}, kVariance);
  EXPECT_FALSE(sightings.crossing({{0, 0, 0}, 0.5}, {{1, 0, 0}, 0.3}, 1.0));
  EXPECT_TRUE(sightings.crossing({{0, 0, 0}, 0.3}, {{1, 0, 0}, 0.5}, 1.0));
}

}  // namespace
}  // namespace montecarta::models
