// SPDX-License-Identifier: BSD-3-Clause
#include "filters/models/range_bearing.hpp"

#include "engine/random/stream.hpp"
#include "filters/models/eigen_jacobians.hpp"

#include <gtest/gtest.h>

namespace montecarta::models {
namespace {

struct Case {
  Pose pose;
  Point landmark;
};

Case random_case(RngStream& draw) {
  return {{10.0 * draw.normal(), 10.0 * draw.normal(), wrap(7.0 * draw.normal())},
          {20.0 * draw.normal(), 20.0 * draw.normal()}};
}

/// Central difference of h() by the value `at` points to.
Eigen::Vector2d observation_slope(Case c, double& (*at)(Case&)) {
  const double middle = at(c);
  const double h = 1e-5;
  at(c) = middle + h;
  const auto ahead = predicted_observation(c.pose, c.landmark);
  at(c) = middle - h;
  return to_vector(residual(ahead, predicted_observation(c.pose, c.landmark))) / (2.0 * h);
}

TEST(RangeBearing, JacobiansEqualCentralDifferences) {
  RngStream draw({.seed = 31, .purpose = Draw::test});
  for (int n = 0; n < 200; ++n) {
    const Case c = random_case(draw);
    const auto s = linearised_observation(c.pose, c.landmark);
    Eigen::Matrix<double, 2, 5> expected;
    expected << observation_slope(c, [](Case& v) -> double& { return v.pose.x; }),
        observation_slope(c, [](Case& v) -> double& { return v.pose.y; }),
        observation_slope(c, [](Case& v) -> double& { return v.pose.heading; }),
        observation_slope(c, [](Case& v) -> double& { return v.landmark.x; }),
        observation_slope(c, [](Case& v) -> double& { return v.landmark.y; });
    EXPECT_LT((pose_jacobian(s) - expected.leftCols<3>()).norm(), 1e-6) << "case " << n;
    EXPECT_LT((landmark_jacobian(s) - expected.rightCols<2>()).norm(), 1e-6) << "case " << n;
  }
}

TEST(RangeBearing, PlacingALandmarkInvertsSeeingIt) {
  RngStream draw({.seed = 32, .purpose = Draw::test});
  for (int n = 0; n < 200; ++n) {
    const Case c = random_case(draw);
    const Point there = linearised_place(c.pose, predicted_observation(c.pose, c.landmark)).point;
    EXPECT_NEAR(there.x, c.landmark.x, 1e-12) << "case " << n;
    EXPECT_NEAR(there.y, c.landmark.y, 1e-12) << "case " << n;
  }
}

TEST(RangeBearing, DerivativesOfPlacingInvertThoseOfSeeing) {
  // g(x, h(x, f)) = f for all x and f: Gz Hf = I and Gx + Gz Hx = 0.
  RngStream draw({.seed = 33, .purpose = Draw::test});
  for (int n = 0; n < 200; ++n) {
    const Case c = random_case(draw);
    const auto seen = linearised_observation(c.pose, c.landmark);
    const auto placed = linearised_place(c.pose, seen.observation);
    const Eigen::Matrix2d Gz = observation_jacobian(placed);
    EXPECT_LT((Gz * landmark_jacobian(seen) - Eigen::Matrix2d::Identity()).norm(), 1e-11);
    EXPECT_LT((pose_jacobian(placed) + Gz * pose_jacobian(seen)).norm(), 1e-11);
  }
}

TEST(RangeBearing, ResidualCrossesTheBackwardDirection) {
  const auto difference =
      residual(RangeBearing<double>{5.0, kPi - 0.1}, RangeBearing<double>{4.5, -kPi + 0.1});
  EXPECT_DOUBLE_EQ(difference.range, 0.5);
  EXPECT_NEAR(difference.bearing, -0.2, 1e-12);
}

TEST(RangeBearing, TurningAndShiftingTheWorldChangesNothing) {
  RngStream draw({.seed = 34, .purpose = Draw::test});
  for (int n = 0; n < 200; ++n) {
    const Case c = random_case(draw);
    const Direction<double> turn = direction_of(1.0 + n);
    const auto x = [&](double px, double py) { return px * turn.cosine - py * turn.sine + 4.0; };
    const auto y = [&](double px, double py) { return px * turn.sine + py * turn.cosine - 9.0; };
    const Pose pose{x(c.pose.x, c.pose.y), y(c.pose.x, c.pose.y), wrap(c.pose.heading + 1.0 + n)};
    const Point landmark{x(c.landmark.x, c.landmark.y), y(c.landmark.x, c.landmark.y)};
    const auto change =
        residual(predicted_observation(pose, landmark), predicted_observation(c.pose, c.landmark));
    EXPECT_LT(to_vector(change).norm(), 1e-11) << "case " << n;
  }
}

TEST(RangeBearing, KnowsWhenALandmarkIsTooNear) {
  EXPECT_TRUE(too_near(predicted_observation(Pose{1.0, 1.0, 0.0}, Point{1.0 + 1e-7, 1.0})));
  EXPECT_FALSE(too_near(predicted_observation(Pose{1.0, 1.0, 0.0}, Point{1.001, 1.0})));
}

}  // namespace
}  // namespace montecarta::models
