// SPDX-License-Identifier: BSD-3-Clause
// The laws of every filter that takes fixes of the position.
#include "filters/factory.hpp"
#include "tests/filters/laws/filters_held_to_laws.hpp"
#include "tests/filters/small_world.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace montecarta::filters {
namespace {

std::vector<FilterKind> filters_with_fixes() {
  std::vector<FilterKind> kinds = filters_held_to_laws();
  std::erase_if(kinds, [](const FilterKind& kind) { return !kind.takes_fixes; });
  return kinds;
}

class EveryFilterWithFixes : public testing::TestWithParam<FilterKind> {
 protected:
  static constexpr std::size_t kMembers = 40;
  static SmallWorldSettings rough_world(double sigma_fix) {
    SmallWorldSettings settings{.noise = {.sigma_range = 0.5, .sigma_bearing = 0.1}};
    settings.noise.sigma_fix = sigma_fix;
    return settings;
  }
  static std::unique_ptr<SlamFilter> make(const SmallWorldSettings& world,
                                          OptionTexts special = {}) {
    special["particles"] = std::to_string(kMembers);
    return make_filter(GetParam(), world, special);
  }
  static std::size_t particles() { return GetParam().reports.particles ? kMembers : 0; }
};

TEST_P(EveryFilterWithFixes, IsNearerToTheTruthWithThem) {
  double with = 0.0, without = 0.0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SmallWorldSettings rough = rough_world(0.1);
    rough.seed = seed;
    const SmallWorld world = small_world(rough);
    const auto filter = make(rough);
    const auto squared_error = [&](const SmallWorld& driven) {
      double sum = 0.0;
      drive_through(*filter, driven, Pose(), [&](std::size_t scan) {
        const Pose& truth = driven.drive.truth[driven.itinerary.scan_step[scan]];
        sum += boxminus(truth, filter->estimate().spread.mean).head<2>().squaredNorm();
      });
      return sum;
    };
    without += squared_error(world);
    with += squared_error(with_fixes(world, rough.noise));
  }
  EXPECT_LT(with, 0.7 * without);
}

/// Fixes whose deviation is immense say nothing.
TEST_P(EveryFilterWithFixes, IgnoresWorthlessOnes) {
  const SmallWorldSettings worthless = rough_world(1e7);
  const SmallWorld world = small_world(worthless);
  const auto filter = make(worthless, {{"resample_below", "0"}});
  const std::vector<PoseMoments> without = estimates_of(*filter, world);
  SmallWorld fixed = with_fixes(world, worthless.noise);
  const std::vector<PoseMoments> with = estimates_of(*filter, fixed);
  for (std::size_t s = 0; s < without.size(); ++s) {
    EXPECT_LT(boxminus(with[s].mean, without[s].mean).norm(), 1e-5) << "scan " << s;
  }
}

TEST_P(EveryFilterWithFixes, UsesOneWithoutAnyDetection) {
  const SmallWorldSettings exact = rough_world(1e-3);
  const auto filter = make(exact);
  filter->start({});
  const StepContext context(1, 0, 0, Parallel::serial());
  for (int step = 0; step < 40; ++step) filter->predict(context, {3.0, 0.0}, 0.025);
  const PoseMoments before = filter->estimate().spread;
  const PositionFix fix(before.mean.x + 0.05, before.mean.y - 0.03);
  filter->take_fix(fix);
  filter->update(context, {});
  const PoseEstimate after = filter->estimate();
  const PoseMoments& judged = after.mixture ? *after.mixture : after.spread;
  // Particles without a Gaussian of their own can only be weighed.
  const bool has_gaussians = after.mixture || particles() == 0;
  EXPECT_LT((place_of(judged.mean) - fix).norm(), has_gaussians ? 0.01 : 0.06);
  EXPECT_TRUE(std::isfinite(filter->report().log_likelihood));
  EXPECT_NE(filter->report().log_likelihood, 0.0);
}

TEST_P(EveryFilterWithFixes, ForgetsAFixOfARunBefore) {
  const SmallWorldSettings usual = rough_world(0.1);
  const SmallWorld world = with_fixes(small_world(usual), usual.noise, 4);
  const auto used = make(usual), fresh = make(usual);
  used->start({});
  used->take_fix({100.0, 100.0});
  EXPECT_TRUE(told(*used, particles(), world) == told(*fresh, particles(), world));
}

TEST_P(EveryFilterWithFixes, TurningTheWorldTurnsTheEstimate) {
  const SmallWorldSettings usual{.noise = {.sigma_fix = 0.3}};
  const auto filter = make(usual, {{"moments", "pushed"}});
  expect_turns_with_the_world(*filter, with_fixes(small_world(usual), usual.noise, 2));
}

TEST_P(EveryFilterWithFixes, GivesTheSameBitsOnAnyNumberOfThreads) {
  const SmallWorldSettings usual = rough_world(0.1);
  const SmallWorld world = with_fixes(small_world(usual), usual.noise, 2);
  const auto filter = make(usual);
  const auto alone = told(*filter, particles(), world, Parallel(Backend::serial, 1));
  EXPECT_TRUE(told(*filter, particles(), world, Parallel(Backend::tbb, 3)) == alone);
}

INSTANTIATE_TEST_SUITE_P(All, EveryFilterWithFixes, testing::ValuesIn(filters_with_fixes()),
                         [](const auto& instance) { return instance.param.name; });
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(EveryFilterWithFixes);

}  // namespace
}  // namespace montecarta::filters
