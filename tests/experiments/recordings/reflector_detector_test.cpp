// SPDX-License-Identifier: BSD-3-Clause
#include "engine/numbers/angle.hpp"
#include "experiments/recordings/laser.hpp"

#include <gtest/gtest.h>

#include <array>
#include <map>

namespace montecarta::experiments {
namespace {

/// The poles in a sweep of walls at 5 m with bright echoes of these ranges [m] at these beams.
std::vector<Detection> poles_in(const std::map<std::size_t, double>& echoes) {
  std::array<double, kLaserBeams> ranges, intensities;
  ranges.fill(5.0);
  intensities.fill(0.0);
  for (const auto& [beam, range] : echoes) {
    ranges[beam] = range;
    intensities[beam] = 8192.0;
  }
  return detect_reflectors(ranges, intensities);
}

TEST(ReflectorDetector, TakesMeanRangeAndAngleOfBrightEchoes) {
  const auto poles = poles_in({{200, 10.0}, {201, 10.2}, {203, 10.1}});
  ASSERT_EQ(poles.size(), 1U);
  EXPECT_NEAR(poles[0][0], 10.1 + 0.03, 1e-12) << "the pole's centre is 3 cm behind its face";
  EXPECT_NEAR(poles[0][1], (604.0 / 3 - 180) * kPi / 360, 1e-12);
  EXPECT_EQ(poles[0].identity, Detection::kUnidentified);
}

TEST(ReflectorDetector, PartsPolesByAngleAndRange) {
  EXPECT_EQ(poles_in({{200, 10.0}, {203, 10.0}}).size(), 1U);
  EXPECT_EQ(poles_in({{200, 10.0}, {204, 10.0}}).size(), 2U);
  EXPECT_EQ(poles_in({{200, 10.0}, {201, 11.0}}).size(), 1U);
  EXPECT_EQ(poles_in({{200, 10.0}, {201, 11.01}}).size(), 2U);
}

TEST(ReflectorDetector, SeesNothingInWallsAndWhereNothingComesBack) {
  EXPECT_TRUE(poles_in({}).empty());
  EXPECT_TRUE(poles_in({{200, 80.0}}).empty());
}

}  // namespace
}  // namespace montecarta::experiments
