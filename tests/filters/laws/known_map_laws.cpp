// SPDX-License-Identifier: BSD-3-Clause
// The laws of every filter that can be given the map.
#include "filters/factory.hpp"
#include "tests/filters/laws/filters_held_to_laws.hpp"
#include "tests/filters/small_world.hpp"
#include "tests/filters/some_models.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace montecarta::filters {
namespace {

constexpr std::size_t kParticles = 30;

std::vector<FilterKind> filters_with_prior() {
  std::vector<FilterKind> kinds = filters_held_to_laws();
  std::erase_if(kinds, [](const FilterKind& kind) { return !kind.takes_prior; });
  return kinds;
}

class EveryFilterInAKnownMap : public testing::TestWithParam<FilterKind> {
 protected:
  static std::unique_ptr<SlamFilter> make(const SmallWorldSettings& world,
                                          Association association = Association::known,
                                          OptionTexts special = {}) {
    special["particles"] = std::to_string(kParticles);
    return GetParam().make(in_known_map(setup_for(GetParam(), world, special, association)));
  }
  static std::size_t particles() { return GetParam().reports.particles ? kParticles : 0; }
};

/// Clutter and far landmarks among the detections.
SmallWorld with_clutter(SmallWorld world) {
  for (std::size_t k = 0; k < world.drive.detections.size(); k += 5) {
    Detection& detection = world.drive.detections[k];
    detection[0] += 4.0;
    detection.identity = Detection::kClutter;
  }
  return world;
}

TEST_P(EveryFilterInAKnownMap, InitialisesNoLandmark) {
  const SmallWorldSettings settings{.landmarks = 18};
  const SmallWorld world = with_clutter(in_known_map(small_world(settings), {.landmark = 0.2}));
  for (const auto association : {Association::known, Association::nearest}) {
    const auto filter = make(settings, association);
    drive_through(*filter, world, Pose(), [&](std::size_t) {
      EXPECT_NEAR(filter->report().map_size, 18.0, 1e-9);
      EXPECT_EQ(filter->report().association.new_again, 0.0);
    });
  }
}

TEST_P(EveryFilterInAKnownMap, LeavesAnExactMapAsItIs) {
  const SmallWorldSettings settings;
  const SmallWorld world = in_known_map(small_world(settings), {.position = 0.5, .heading = 0.1});
  const auto filter = make(settings);
  drive_through(*filter, world);
  EXPECT_GT(filter->report().nis_dof, 0U);
  std::vector<std::optional<LandmarkEstimate>> map(settings.landmarks);
  filter->map(map);
  for (std::size_t k = 0; k < map.size(); ++k) {
    ASSERT_TRUE(map[k].has_value()) << "landmark " << k;
    EXPECT_LT((map[k]->mean - world.itinerary.landmarks[k]).norm(), 1e-9) << "landmark " << k;
    EXPECT_LT(map[k]->covariance.norm(), 1e-12) << "landmark " << k;
  }
}

TEST_P(EveryFilterInAKnownMap, FindsTheVehicleFromAnUncertainStartWithEverySensor) {
  for (const SomeSensor& sensor : some_sensors()) {
    if (!takes(GetParam(), sensor.sensor)) continue;
    SCOPED_TRACE(sensor.name);
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      SmallWorldSettings settings{.seed = seed};
      settings.noise.sensor = sensor.sensor;
      const SmallWorld world =
          in_known_map(small_world(settings), {.position = 0.2, .heading = 0.02});
      const auto filter = make(settings);
      drive_through(*filter, world);
      const PoseMoments now = filter->estimate().spread;
      EXPECT_LT(boxminus(world.drive.truth.back(), now.mean).norm(), 0.5) << "seed " << seed;
      EXPECT_LT(now.covariance.trace(), 0.1) << "seed " << seed;
    }
  }
}

TEST_P(EveryFilterInAKnownMap, ForgetsIt) {
  const SmallWorldSettings settings;
  const SmallWorld known = in_known_map(small_world(settings), {.position = 0.5, .landmark = 0.1});
  const SmallWorld unknown = small_world(settings);
  const auto used = make(settings), fresh = make(settings);
  drive_through(*used, known);
  EXPECT_TRUE(told(*used, particles(), unknown) == told(*fresh, particles(), unknown));
}

TEST_P(EveryFilterInAKnownMap, TurningTheWorldTurnsTheEstimate) {
  const SmallWorldSettings settings;
  for (const double landmark : {0.0, 0.1}) {
    SCOPED_TRACE(landmark);
    const auto filter = make(settings, Association::known, {{"moments", "pushed"}});
    expect_turns_with_the_world(
        *filter, in_known_map(small_world(settings),
                              {.position = 0.3, .heading = 0.05, .landmark = landmark}));
  }
}

TEST_P(EveryFilterInAKnownMap, GivesTheSameBitsOnAnyNumberOfThreads) {
  const SmallWorldSettings settings{.scans = 5};
  const SmallWorld world =
      in_known_map(small_world(settings), {.position = 0.3, .heading = 0.05, .landmark = 0.1});
  const auto filter = make(settings);
  const auto alone = told(*filter, particles(), world, Parallel(Backend::serial, 1));
  EXPECT_TRUE(told(*filter, particles(), world, Parallel(Backend::tbb, 3)) == alone);
}

INSTANTIATE_TEST_SUITE_P(All, EveryFilterInAKnownMap, testing::ValuesIn(filters_with_prior()),
                         [](const auto& instance) { return instance.param.name; });
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(EveryFilterInAKnownMap);

}  // namespace
}  // namespace montecarta::filters
