// SPDX-License-Identifier: BSD-3-Clause
// Over whole laps, plain and fast filters have the same consistency and the same errors.
#include "tests/filters/fastslam/filter_comparison.hpp"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace montecarta::filters {
namespace {

constexpr std::uint64_t kRuns = 4;

/// Averages over the scans of one run.
struct LapAverages {
  double nees = 0.0;
  double squared_error = 0.0;  ///< of the position [m^2]
};

LapAverages averages_of(SlamFilter& filter, const SmallWorld& world) {
  LapAverages averages;
  const auto scans = static_cast<double>(world.itinerary.scans());
  drive_through(filter, world, Pose(), [&](std::size_t scan) {
    const PoseMoments belief = filter.estimate().spread;
    const Eigen::Vector3d error =
        boxminus(world.drive.truth[world.itinerary.scan_step[scan]], belief.mean);
    averages.nees += error.dot(belief.covariance.ldlt().solve(error)) / scans;
    averages.squared_error += error.head<2>().squaredNorm() / scans;
  });
  return averages;
}

class WholeLaps : public testing::TestWithParam<std::string> {};

// Both draw the same random numbers, so they agree much closer than their three standard errors.
// They could only part if rounding decided a resampling or a trial of evolution, which happens in
// none of these runs.
TEST_P(WholeLaps, HaveTheAneesAndTheRmseOfTheFastFilter) {
  const Variant variant{.filter = GetParam(), .particles = 20};
  SmallWorldSettings settings{.landmarks = 12, .scans = 290};  // a lap is 283 scans
  for (settings.seed = 700; settings.seed < 700 + kRuns; ++settings.seed) {
    const SmallWorld world = small_world(settings);
    const LapAverages fast = averages_of(*make_production(variant, settings), world);
    const LapAverages plain = averages_of(*make_plain(variant, settings), world);
    EXPECT_NEAR(plain.nees / fast.nees, 1.0, 1e-8) << "seed " << settings.seed;
    EXPECT_NEAR(std::sqrt(plain.squared_error), std::sqrt(fast.squared_error), 1e-9)
        << "seed " << settings.seed;
  }
}

std::vector<std::string> fast_filters() {
  std::vector<std::string> names;
  for (const FilterKind& kind : filter_kinds()) {
    if (kind.name.starts_with("plain_")) names.push_back(kind.name.substr(6));
  }
  return names;
}

INSTANTIATE_TEST_SUITE_P(EveryPlain, WholeLaps, testing::ValuesIn(fast_filters()),
                         [](const auto& instance) { return instance.param; });

}  // namespace
}  // namespace montecarta::filters
