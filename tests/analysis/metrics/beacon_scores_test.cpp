// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/map_scores.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace montecarta::analysis {
namespace {

using Points = std::vector<Eigen::Vector2d>;

const Points kBeacons = {{0.0, 0.0}, {10.0, 0.0}, {10.0, 10.0}};

TEST(BeaconScores, CountsBeaconsWithinAMetreAndMeasuresThem) {
  const BeaconScores scores =
      beacon_scores(Points{{0.6, 0.0}, {10.6, 0.0}, {10.0, 11.1}, {50.0, 50.0}}, kBeacons, {});
  EXPECT_EQ(scores.found, 2.0);
  EXPECT_NEAR(scores.rms, 0.6, 1e-12);
  EXPECT_NEAR(scores.aligned_rms, 0.6, 1e-12);
}

TEST(BeaconScores, FindsThemWhereThePathIsAlignedAndSaysHowFarTheyWere) {
  const RigidMotion along_x{.angle = 0.0, .shift = {-3.0, 0.0}};
  const BeaconScores scores =
      beacon_scores(Points{{3.0, 0.0}, {13.0, 0.1}, {13.0, 10.0}}, kBeacons, along_x);
  EXPECT_EQ(scores.found, 3.0);
  EXPECT_NEAR(scores.rms, std::sqrt(9.0 + 0.01 / 3.0), 1e-12);
  EXPECT_NEAR(scores.aligned_rms, std::sqrt(0.01 / 3.0), 1e-12);
}

TEST(BeaconScores, ALandmarkStandsForOneBeaconTheNearerFirst) {
  const Points close = {{0.0, 0.0}, {1.0, 0.0}};
  const BeaconScores one = beacon_scores(Points{{0.7, 0.0}}, close, {});
  EXPECT_EQ(one.found, 1.0);
  EXPECT_NEAR(one.rms, 0.3, 1e-12);
  EXPECT_EQ(beacon_scores(Points{{0.7, 0.0}, {0.6, 0.0}}, close, {}).found, 2.0);
}

TEST(BeaconScores, FindsNothingInAnEmptyMap) {
  const BeaconScores scores = beacon_scores({}, kBeacons, {});
  EXPECT_EQ(scores.found, 0.0);
  EXPECT_TRUE(std::isnan(scores.rms));
}

}  // namespace
}  // namespace montecarta::analysis
