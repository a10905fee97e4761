// SPDX-License-Identifier: BSD-3-Clause
// A test of one's own beside the laws, on the world that the shipped filters are tested on.
#include "filters/dead_reckoning.hpp"
#include "tests/filters/small_world.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace montecarta::filters {
namespace {

TEST(MyFilter, EndsWhereTheNoiseOfTheControlsLeavesIt) {
  const SmallWorldSettings settings;
  const SmallWorld world = small_world(settings);
  const auto filter = make_filter(dead_reckoning_kind(), settings);
  drive_through(*filter, world, world.itinerary.start, [](std::size_t /*scan*/) {});
  const auto [mean, covariance] = filter->estimate().spread;
  const Pose& truth = world.drive.truth.back();
  EXPECT_NEAR(mean.x, truth.x, 4.0 * std::sqrt(covariance(0, 0)));
  EXPECT_NEAR(mean.y, truth.y, 4.0 * std::sqrt(covariance(1, 1)));
}

}  // namespace
}  // namespace montecarta::filters
