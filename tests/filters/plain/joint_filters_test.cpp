// SPDX-License-Identifier: BSD-3-Clause
// The plain joint filters have the means and covariances of the fast ones at every step.
#include "filters/factory.hpp"
#include "tests/filters/small_world.hpp"
#include "tests/filters/some_models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::filters {
namespace {

constexpr double kTolerance = 1e-8;
/// [m^2] Size of covariances of exactly known landmarks, which are differences of numbers of this
/// size in invariant coordinates.
constexpr double kLeastCovariance = 1e-4;
const Pose kStart{4.0, -3.0, 0.5};

/// So much noise on the bearing that the joint filters part.
Belief rough() { return {.control = {.sigma = {0.3, 0.1}}, .sigma_bearing = 0.05}; }

const FilterKind& kind_named(const std::string& name) {
  return *std::ranges::find(filter_kinds(), name, &FilterKind::name);
}
std::unique_ptr<SlamFilter> named(const std::string& name, const SmallWorldSettings& settings,
                                  Association association, const SmallWorld& world) {
  const FilterKind& kind = kind_named(name);
  const FilterSetup setup = setup_for(kind, settings, {}, association);
  return kind.make(world.drive.prior ? in_known_map(setup) : setup);
}

/// Covariances agree relative to their size.
void expect_equal(const PoseMoments& plain, const PoseMoments& fast) {
  EXPECT_LT(boxminus(plain.mean, fast.mean).norm(), kTolerance);
  EXPECT_LE((plain.covariance - fast.covariance).norm(), kTolerance * fast.covariance.norm());
}
void expect_equal(const ScanReport& plain, const ScanReport& fast) {
  EXPECT_NEAR(plain.log_likelihood, fast.log_likelihood,
              kTolerance * (1.0 + std::abs(fast.log_likelihood)));
  EXPECT_NEAR(plain.nis, fast.nis, kTolerance * (1.0 + fast.nis));
  EXPECT_EQ(plain.nis_dof, fast.nis_dof);
  EXPECT_EQ(plain.map_size, fast.map_size);
}
void expect_equal_maps(const SlamFilter& plain, const SlamFilter& fast, std::size_t landmarks) {
  std::vector<std::optional<LandmarkEstimate>> a(landmarks), b(landmarks);
  plain.map(a), fast.map(b);
  for (std::size_t k = 0; k < landmarks; ++k) {
    ASSERT_EQ(a[k].has_value(), b[k].has_value()) << "landmark " << k;
    if (!a[k]) continue;
    EXPECT_LT((a[k]->mean - b[k]->mean).norm(), kTolerance) << "landmark " << k;
    const double size = std::max(b[k]->covariance.norm(), kLeastCovariance);
    EXPECT_LE((a[k]->covariance - b[k]->covariance).norm(), kTolerance * size) << "landmark " << k;
  }
}

class PlainJointFilter : public testing::TestWithParam<std::string> {
 protected:
  struct Pair {
    std::unique_ptr<SlamFilter> plain, fast;
  };
  /// Drives both through the world, compares what they report at every step, and returns them.
  static Pair compared(const SmallWorldSettings& settings,
                       Association association = Association::known) {
    return compared(settings, association, small_world(settings));
  }
  static Pair compared(const SmallWorldSettings& settings, Association association,
                       const SmallWorld& world) {
    Pair both{named("plain_" + GetParam(), settings, association, world),
              named(GetParam(), settings, association, world)};
    const auto& [plain, fast] = both;
    start_in(world, kStart, *plain), start_in(world, kStart, *fast);
    std::uint32_t scan = 0, compared_dof = 0;
    for (std::uint32_t step = 0; step < world.itinerary.steps(); ++step) {
      SCOPED_TRACE(testing::Message() << "step " << step);
      const StepContext context(world.seed, 0, step, Parallel::serial());
      for (SlamFilter* filter : {plain.get(), fast.get()})
        filter->predict(context, world.drive.controls[step], world.itinerary.duration(step));
      expect_equal(plain->estimate().spread, fast->estimate().spread);
      if (world.itinerary.scan_step[scan] != step) continue;
      for (SlamFilter* filter : {plain.get(), fast.get()})
        update_with_scan(*filter, context, world, scan);
      ++scan;
      expect_equal(plain->estimate().spread, fast->estimate().spread);
      expect_equal(plain->report(), fast->report());
      expect_equal_maps(*plain, *fast, settings.landmarks);
      compared_dof += fast->report().nis_dof;
    }
    EXPECT_GT(compared_dof, 2 * settings.scans) << "landmarks were hardly observed again";
    return both;
  }
};

TEST_P(PlainJointFilter, EqualsTheFastFilterForALapAndAHalf) {
  const SmallWorldSettings settings{.seed = 5, .landmarks = 21, .scans = 430, .noise = rough()};
  const auto both = compared(settings);
  EXPECT_EQ(both.fast->report().map_size, 21.0);
}

TEST_P(PlainJointFilter, EqualsTheFastFilterThatAssociatesNearestNeighbours) {
  const SmallWorldSettings settings{.seed = 6, .landmarks = 21, .scans = 300};
  const auto both = compared(settings, Association::nearest);
  EXPECT_GE(both.fast->report().map_size, 21.0);
}

/// The filters that can be given a map.
class PlainLocalisation : public PlainJointFilter {};

TEST_P(PlainLocalisation, EqualsTheFastFilterInAKnownMap) {
  const SmallWorldSettings settings{.seed = 9, .scans = 100, .noise = rough()};
  for (const auto association : {Association::known, Association::nearest}) {
    for (const double landmark : {0.0, 0.3}) {
      SCOPED_TRACE(landmark);
      compared(settings, association,
               in_known_map(small_world(settings),
                            {.position = 0.5, .heading = 0.2, .landmark = landmark}));
    }
  }
}

/// The filters that take fixes of the position.
class PlainFilterWithFixes : public PlainJointFilter {};

TEST_P(PlainFilterWithFixes, EqualsTheFastFilterWithFixes) {
  Belief noise = rough();
  noise.sigma_fix = 0.5;
  const SmallWorldSettings settings{.seed = 10, .scans = 150, .noise = noise};
  const SmallWorld world = with_fixes(small_world(settings), noise, 3);
  for (const auto association : {Association::known, Association::nearest}) {
    compared(settings, association, turned(world, kStart));
    compared(settings, association,
             turned(in_known_map(world, {.position = 0.5, .heading = 0.2}), kStart));
  }
}

TEST_P(PlainJointFilter, EqualsTheFastFilterOfEveryVehicle) {
  for (const SomeVehicle& some : some_vehicles()) {
    SCOPED_TRACE(some.name);
    Belief noise = rough();
    noise.vehicle = some.vehicle;
    noise.control.sigma = some.deviations;
    compared({.seed = 7,
              .scans = 60,
              .noise = noise,
              .controls = {some.typical, some.typical, some.typical, some.on_spot}});
  }
}

TEST_P(PlainJointFilter, EqualsTheFastFilterWithNoiseOfTheStep) {
  for (const IncrementNoise& increment : some_increments()) {
    Belief noise = rough();
    noise.control.increment = increment;
    compared({.seed = 11, .scans = 100, .noise = noise});
  }
}

/// Without noise a control of zero is no motion: the points of linearisation stay.
TEST_P(PlainJointFilter, EqualsTheFastFilterOfAVehicleThatStopsAndGoes) {
  Belief noise = rough();
  noise.control = {.sigma = {}, .alpha = {1e-2, 0.0, 1e-3, 0.0}};
  compared({.seed = 8, .scans = 120, .noise = noise, .controls = {{3.0, 0.15}, {0.0, 0.15}}});
}

std::vector<std::string> plain_joint_filters() {
  return {"ekf_slam", "riekf_slam", "fej_ekf_slam", "oc_ekf_slam"};
}

std::vector<std::string> plain_filters_that_take(bool FilterKind::*what) {
  std::vector<std::string> names = plain_joint_filters();
  std::erase_if(names, [what](const std::string& name) { return !(kind_named(name).*what); });
  return names;
}

INSTANTIATE_TEST_SUITE_P(All, PlainJointFilter, testing::ValuesIn(plain_joint_filters()),
                         [](const auto& instance) { return instance.param; });
INSTANTIATE_TEST_SUITE_P(All, PlainLocalisation,
                         testing::ValuesIn(plain_filters_that_take(&FilterKind::takes_prior)),
                         [](const auto& instance) { return instance.param; });
INSTANTIATE_TEST_SUITE_P(All, PlainFilterWithFixes,
                         testing::ValuesIn(plain_filters_that_take(&FilterKind::takes_fixes)),
                         [](const auto& instance) { return instance.param; });

}  // namespace
}  // namespace montecarta::filters
