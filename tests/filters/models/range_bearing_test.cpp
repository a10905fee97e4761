// SPDX-License-Identifier: BSD-3-Clause
#include "filters/models/range_bearing.hpp"

#include "engine/random/stream.hpp"
#include "filters/models/eigen_jacobians.hpp"

#include <gtest/gtest.h>

namespace montecarta::models {
namespace {

// Derivatives and placing are held to the laws of every sensor.
TEST(RangeBearing, PredictedIsWhatIsLinearised) {
  RngStream draw({.seed = 31, .purpose = Draw::test});
  for (int n = 0; n < 200; ++n) {
    const Pose pose{10.0 * draw.normal(), 10.0 * draw.normal(), wrap(7.0 * draw.normal())};
    const Point landmark{20.0 * draw.normal(), 20.0 * draw.normal()};
    const auto change = residual(predicted_observation(pose, landmark),
                                 linearised_observation(pose, landmark).observation);
    EXPECT_LT(to_vector(change).norm(), 1e-12) << "case " << n;
  }
}

TEST(RangeBearing, ResidualCrossesTheBackwardDirection) {
  const auto difference =
      residual(RangeBearing<double>{5.0, kPi - 0.1}, RangeBearing<double>{4.5, -kPi + 0.1});
  EXPECT_DOUBLE_EQ(difference.range, 0.5);
  EXPECT_NEAR(difference.bearing, -0.2, 1e-12);
}

TEST(RangeBearing, KnowsWhenALandmarkIsTooNear) {
  EXPECT_TRUE(too_near(predicted_observation(Pose{1.0, 1.0, 0.0}, Point{1.0 + 1e-7, 1.0})));
  EXPECT_FALSE(too_near(predicted_observation(Pose{1.0, 1.0, 0.0}, Point{1.001, 1.0})));
}

}  // namespace
}  // namespace montecarta::models
