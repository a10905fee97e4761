// SPDX-License-Identifier: BSD-3-Clause
// Vehicles other than cars, simulated.
#include "engine/errors.hpp"
#include "experiments/drives/simulated_drive.hpp"
#include "experiments/worlds/world.hpp"
#include "tests/filters/some_models.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace montecarta::experiments {
namespace {

/// A narrow way there and back: at both ends the next way-point is behind.
World there_and_back() {
  World world;
  world.name = "there_and_back";
  world.landmarks = {{5.0, 3.0}, {15.0, -3.0}};
  world.waypoints = {{20.0, 0.0}, {0.0, 0.0}};
  return world;
}

Scenario scenario_of(const Vehicle& vehicle) {
  return {.noise = NoiseMode::matched,
          .vehicle = vehicle,
          .speed = 1.0,
          .control = {.sigma = {0.1, 0.05, 0.05}},
          .waypoint_radius = 0.3};
}

class EveryVehicleDrives : public testing::TestWithParam<SomeVehicle> {};

TEST_P(EveryVehicleDrives, ThroughAShippedWorldAndTheSameAgain) {
  const SimulatedDrive source(find_world("web_loop"), {.vehicle = GetParam().vehicle}, 3);
  Drive first, again;
  source.generate(5, first);
  source.generate(6, again);
  source.generate(5, again);
  ASSERT_EQ(first.controls.size(), again.controls.size());
  const auto same = [](const Control& a, const Control& b) { return a.values == b.values; };
  EXPECT_TRUE(std::ranges::equal(first.controls, again.controls, same));
  EXPECT_GT(first.detections.size(), 1000U);
}

INSTANTIATE_TEST_SUITE_P(All, EveryVehicleDrives, testing::ValuesIn(some_vehicles()),
                         [](const auto& instance) { return instance.param.name; });

TEST(VehicleDrive, ADifferentialDriveTurnsOnTheSpotAndThatIsNoStanding) {
  const SimulatedDrive source(there_and_back(), scenario_of(DifferentialDrive{}), 1);
  EXPECT_EQ(source.itinerary().moving_controls, 2U);
  Drive drive;
  source.generate(0, drive);
  const auto on_spot = [](const Control& c) { return c[0] == 0.0 && c[1] != 0.0; };
  const auto turns = std::ranges::count_if(drive.controls, on_spot);
  // 135 of 180 degrees at 90 deg/s and 40 Hz
  EXPECT_GT(turns, 50);
  EXPECT_LT(turns, 80);
  for (const Control& control : drive.controls) EXPECT_FALSE(control.stands(2));
}

/// Sum of squares of each component of what the filter is given less what the vehicle obeys.
Eigen::Array2d noise_of(const SimulatedDrive& noisy, const SimulatedDrive& exact) {
  Drive a, b;
  noisy.generate(0, a), exact.generate(0, b);
  Eigen::Array2d sum = Eigen::Array2d::Zero();
  for (std::size_t k = 0; k < a.controls.size(); ++k) {
    const Control &with = a.controls[k], &without = b.controls[k];
    const Eigen::Array2d error(with[0] - without[0], with[1] - without[1]);
    sum += error.square();
  }
  return sum / static_cast<double>(a.controls.size());
}

TEST(VehicleDrive, SaysThatItStepsOverAWaypoint) {
  Scenario scenario = scenario_of(Omnidirectional{});
  scenario.speed = 300.0;
  scenario.control_rate = 20.0;
  try {
    const SimulatedDrive source(there_and_back(), scenario, 1);
    ADD_FAILURE() << "reached in " << source.itinerary().steps() << " steps";
  } catch (const StudyError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("steps over it, 15 m at a time): lower "
                                                 "scenario.speed"));
  }
}

TEST(VehicleDrive, NoiseThatGrowsWithTheMotionHasTheVarianceThatIsSaid) {
  Scenario scenario = scenario_of(Car{.wheelbase = 1.0});
  scenario.noise = NoiseMode::measured_control;
  scenario.loops = 20;
  scenario.control = {.sigma = {0.1, 0.05}, .alpha = {0.04, 0.0, 0.01, 0.0}};
  Scenario exact = scenario;
  exact.control = {};
  const World world = there_and_back();
  const Eigen::Array2d found =
      noise_of(SimulatedDrive(world, scenario, 1), SimulatedDrive(world, exact, 1));
  const Eigen::Array2d expected(0.01 + 0.04, 0.0025 + 0.01);
  // n > 30,000 steps: a variance is good to 0.8 %
  EXPECT_TRUE(((found / expected - 1.0).abs() < 0.04).all()) << found;
}

}  // namespace
}  // namespace montecarta::experiments
