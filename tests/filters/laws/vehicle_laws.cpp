// SPDX-License-Identifier: BSD-3-Clause
// The laws of every filter with every vehicle. The path turns on the spot again and again.
#include "filters/factory.hpp"
#include "tests/filters/laws/filters_held_to_laws.hpp"
#include "tests/filters/small_world.hpp"
#include "tests/filters/some_models.hpp"

#include <gtest/gtest.h>

#include <string>

namespace montecarta::filters {
namespace {

constexpr std::size_t kParticles = 30;

class EveryFilterAndVehicle : public testing::TestWithParam<FilterKind> {
 protected:
  static SmallWorldSettings settings_of(const SomeVehicle& some) {
    Belief noise{.vehicle = some.vehicle};
    noise.control = {.sigma = some.deviations, .alpha = {1e-3, 1e-3, 1e-4, 1e-2}};
    return {.scans = 24,
            .noise = noise,
            .controls = {some.typical, some.typical, some.typical, some.on_spot}};
  }
  /// Calls law(filter, world) with every vehicle.
  template <class Law>
  void on_every_vehicle(const Law& law) const {
    for (const SomeVehicle& some : some_vehicles()) {
      SCOPED_TRACE(some.name);
      const SmallWorldSettings settings = settings_of(some);
      law(*make_filter(GetParam(), settings, {{"particles", std::to_string(kParticles)}}),
          small_world(settings));
    }
  }
};

TEST_P(EveryFilterAndVehicle, TurningTheWorldTurnsTheEstimate) {
  on_every_vehicle(expect_turns_with_the_world);
}

TEST_P(EveryFilterAndVehicle, TurnsWithTheWorldWithNoiseOfTheStep) {
  for (const IncrementNoise& increment : some_increments()) {
    for (const SomeVehicle& some : some_vehicles()) {
      SCOPED_TRACE(some.name);
      SmallWorldSettings settings = settings_of(some);
      settings.noise.control.increment = increment;
      const auto filter =
          make_filter(GetParam(), settings, {{"particles", std::to_string(kParticles)}});
      expect_turns_with_the_world(*filter, small_world(settings));
    }
  }
}

TEST_P(EveryFilterAndVehicle, StaysNearTheTruth) {
  on_every_vehicle([](SlamFilter& filter, const SmallWorld& world) {
    drive_through(filter, world, Pose(), [&](std::size_t scan) {
      const Pose& truth = world.drive.truth[world.itinerary.scan_step[scan]];
      const Eigen::Vector3d error = boxminus(filter.estimate().spread.mean, truth);
      EXPECT_LT(error.head<2>().norm(), 1.5) << "scan " << scan;
      EXPECT_LT(std::abs(error(2)), 0.15) << "scan " << scan;
    });
  });
}

TEST_P(EveryFilterAndVehicle, GivesTheSameBitsAgain) {
  const std::size_t n = GetParam().reports.particles ? kParticles : 0;
  on_every_vehicle([&](SlamFilter& filter, const SmallWorld& world) {
    EXPECT_TRUE(told(filter, n, world) == told(filter, n, world));
  });
}

INSTANTIATE_TEST_SUITE_P(All, EveryFilterAndVehicle, testing::ValuesIn(filters_held_to_laws()),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace montecarta::filters
