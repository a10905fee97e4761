// SPDX-License-Identifier: BSD-3-Clause
// The laws of every filter with every vehicle. The path turns on the spot again and again.
#include "filters/factory.hpp"
#include "tests/filters/laws/filters_held_to_laws.hpp"
#include "tests/filters/small_world.hpp"
#include "tests/filters/some_models.hpp"

#include <gtest/gtest.h>

#include <string>
#include <tuple>

namespace montecarta::filters {
namespace {

constexpr std::size_t kParticles = 30;

class EveryFilterAndVehicle : public testing::TestWithParam<std::tuple<FilterKind, SomeVehicle>> {
 protected:
  const FilterKind& kind() const { return std::get<FilterKind>(GetParam()); }
  SmallWorldSettings settings() const {
    const SomeVehicle& some = std::get<SomeVehicle>(GetParam());
    Belief noise{.vehicle = some.vehicle};
    noise.control = {.sigma = some.deviations, .alpha = {1e-3, 1e-3, 1e-4, 1e-2}};
    return {.scans = 24,
            .noise = noise,
            .controls = {some.typical, some.typical, some.typical, some.on_spot}};
  }
  std::unique_ptr<SlamFilter> make() const {
    return make_filter(kind(), settings(), {{"particles", std::to_string(kParticles)}});
  }
};

TEST_P(EveryFilterAndVehicle, TurningTheWorldTurnsTheEstimate) {
  expect_turns_with_the_world(*make(), small_world(settings()));
}

TEST_P(EveryFilterAndVehicle, StaysNearTheTruth) {
  const SmallWorld world = small_world(settings());
  const auto filter = make();
  drive_through(*filter, world, Pose(), [&](std::size_t scan) {
    const Pose& truth = world.drive.truth[world.itinerary.scan_step[scan]];
    const Eigen::Vector3d error = boxminus(filter->estimate().spread.mean, truth);
    EXPECT_LT(error.head<2>().norm(), 1.5) << "scan " << scan;
    EXPECT_LT(std::abs(error(2)), 0.15) << "scan " << scan;
  });
}

TEST_P(EveryFilterAndVehicle, GivesTheSameBitsAgain) {
  const SmallWorld world = small_world(settings());
  const auto filter = make();
  const std::size_t n = kind().reports.particles ? kParticles : 0;
  EXPECT_TRUE(told(*filter, n, world) == told(*filter, n, world));
}

INSTANTIATE_TEST_SUITE_P(All, EveryFilterAndVehicle,
                         testing::Combine(testing::ValuesIn(filters_held_to_laws()),
                                          testing::ValuesIn(some_vehicles())),
                         [](const auto& instance) {
                           return std::get<0>(instance.param).name + "_" +
                                  std::get<1>(instance.param).name;
                         });

}  // namespace
}  // namespace montecarta::filters
