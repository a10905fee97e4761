// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/delayed_association.hpp"

#include <gtest/gtest.h>

#include <array>

namespace montecarta::filters {
namespace {

const StepContext kContext(0, 0, 0, Parallel::serial());

/// Two particles, of which the first one is at the true pose.
class TwoParticles : public testing::Test {
 protected:
  static constexpr double kBeside = 0.5;  ///< [m] how far the second one stands to the left

  explicit TwoParticles(const SensorKind& kind) : belief_{.sensor = {kind, {.forward = 0.3}}} {}

  /// One detection without noise from `pose`; returns whether the landmark is fixed.
  bool look(const Pose& pose) {
    const Point landmark{15.0, 12.0};
    const Detection seen{linearised_detection(belief_.sensor, pose, landmark)->value(0), 0.0, 0};
    return waiting_.advance(kContext, seen, {pose, {pose.x, pose.y + kBeside, pose.heading}});
  }
  std::array<LandmarkGaussian<double>, 2> place() {
    std::array<LandmarkGaussian<double>, 2> blocks{};
    waiting_.place(kContext, 0, blocks);
    return blocks;
  }

  Belief belief_;
  InitialisationOnPaths<double> waiting_{2, belief_};
};

class TwoParticlesOfBearings : public TwoParticles {
 protected:
  TwoParticlesOfBearings() : TwoParticles(BearingSensor()) {}
};
class TwoParticlesOfRanges : public TwoParticles {
 protected:
  TwoParticlesOfRanges() : TwoParticles(RangeSensor()) {}
};

TEST_F(TwoParticlesOfBearings, InitialiseFromTheFirstAndTheOneBehindThatWhichCrossesWell) {
  EXPECT_FALSE(look({0, 0, 0}));
  EXPECT_FALSE(look({0.1, 0, 0}));  // too near
  EXPECT_FALSE(look({8, 0, 0}));    // crosses well, and is dropped
  EXPECT_TRUE(look({9, 0, 0.1}));
  const auto [first, second] = place();
  EXPECT_NEAR(first.mean.x, 15.0, 1e-9);
  EXPECT_NEAR(first.mean.y, 12.0, 1e-9);
  EXPECT_NEAR(second.mean.y, 12.0 + kBeside, 1e-9);
  const TwoSightings pair(belief_.sensor, belief_.sigma_bearing * belief_.sigma_bearing);
  const auto of = [&](const Pose& pose) {
    return Sighting{belief_.sensor.mounting.pose_of(pose),
                    linearised_detection(belief_.sensor, pose, {15.0, 12.0})->value(0)};
  };
  const Eigen::Matrix2d expected = pair.crossing(of({0, 0, 0}), of({9, 0, 0.1}), 1.0)->covariance;
  EXPECT_NEAR(first.covariance.xy, expected(0, 1), 1e-9);
  EXPECT_NEAR(first.covariance.xx, expected(0, 0), 1e-9);
}

TEST_F(TwoParticlesOfBearings, PassTheirPosesOnToTheirDescendants) {
  look({0, 0, 0});
  look({8, 0, 0});
  waiting_.resample(kContext, std::array<std::uint32_t, 2>{1, 1});
  ASSERT_TRUE(look({9, 0, 0.1}));
  // The ray of the ancestor, half a metre to the left, cuts that of the true pose elsewhere.
  const auto [first, second] = place();
  EXPECT_NEAR(second.mean.y, 12.0 + kBeside, 1e-9);
  EXPECT_GT(std::abs(first.mean.y - 12.0), 0.1);
  EXPECT_GT(std::abs(first.mean.y - second.mean.y), 0.1);
}

TEST_F(TwoParticlesOfBearings, ForgetTheRunBefore) {
  look({0, 0, 0});
  look({8, 0, 0});
  waiting_.start();
  EXPECT_FALSE(look({9, 0, 0.1}));
}

TEST_F(TwoParticlesOfRanges, NeedAThirdToTellTheSide) {
  EXPECT_FALSE(look({0, 0, 0}));
  EXPECT_FALSE(look({8, 0, 0}));     // crosses well, and is dropped
  EXPECT_FALSE(look({9, 0, 0}));     // two places
  EXPECT_FALSE(look({10, 0.1, 0}));  // on the line through both: does not tell
  EXPECT_TRUE(look({9, -6, 0}));
  const auto [first, second] = place();
  EXPECT_NEAR(first.mean.x, 15.0, 1e-9);
  EXPECT_NEAR(first.mean.y, 12.0, 1e-9);
  EXPECT_NEAR(second.mean.y, 12.0 + kBeside, 1e-9);
  EXPECT_GT(first.covariance.xx, 0.0);
}

}  // namespace
}  // namespace montecarta::filters
