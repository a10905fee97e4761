// SPDX-License-Identifier: BSD-3-Clause
// What holds for every filter with every vehicle. The path turns on the spot again and again.
#include "filters/factory.hpp"
#include "tests/filters/default_options.hpp"
#include "tests/filters/laws/filters_held_to_laws.hpp"
#include "tests/filters/small_world.hpp"
#include "tests/filters/some_vehicles.hpp"
#include "tests/filters/told_bits.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <vector>

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
    std::map<std::string, std::string, std::less<>> special;
    if (kind().has_particles) special["particles"] = std::to_string(kParticles);
    return kind().make({.belief = settings().noise,
                        .association = {},
                        .options = default_options(kind(), special),
                        .landmarks = settings().landmarks});
  }
};

TEST_P(EveryFilterAndVehicle, TurningTheWorldTurnsTheEstimate) {
  const SmallWorld world = small_world(settings());
  const Pose start{-30.0, 50.0, 2.0};
  const SmallWorld other = turned(world, start);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(start.heading, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const auto filter = make();
  std::vector<PoseMoments> unturned;
  drive_through(*filter, world, Pose(),
                [&](std::size_t) { unturned.push_back(filter->estimate().spread); });
  drive_through(*filter, other, start, [&](std::size_t scan) {
    const PoseMoments now = filter->estimate().spread, &was = unturned[scan];
    EXPECT_LT(boxminus(now.mean, turned(was.mean, start)).norm(), 1e-6) << "scan " << scan;
    EXPECT_LT((now.covariance - turn * was.covariance * turn.transpose()).norm(), 1e-7);
  });
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
  const std::size_t n = kind().has_particles ? kParticles : 0;
  std::vector<ToldBits> first;
  drive_through(*filter, world, Pose(),
                [&](std::size_t) { first.emplace_back(*filter, n, settings().landmarks); });
  drive_through(*filter, world, Pose(), [&](std::size_t scan) {
    EXPECT_TRUE(ToldBits(*filter, n, settings().landmarks) == first[scan]) << "scan " << scan;
  });
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
