// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/drives/simulated_drive.hpp"
#include "filters/models/ackermann.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace montecarta::experiments {
namespace {

TEST(Omnidirectional, WithoutMotionToTheLeftIsADifferentialDrive) {
  for (const double turn : {0.0, 0.3, -2.0}) {
    const auto one = body_step(DifferentialDrive{}, Control{1.5, turn}, 0.4);
    const auto other = body_step(Omnidirectional{}, Control{1.5, 0.0, turn}, 0.4);
    EXPECT_EQ(one.forward, other.forward);
    EXPECT_EQ(one.left, other.left);
    EXPECT_EQ(one.turn, other.turn);
  }
}

TEST(ControlNoise, CountsBothComponentsOfAVelocity) {
  const ControlNoise noise{.sigma = {}, .alpha = {1.0, 0.0, 4.0, 0.0}};
  const auto sigma = deviations_of(noise, {3.0, 4.0, 0.5}, Omnidirectional{});
  EXPECT_DOUBLE_EQ(sigma[0], 5.0);
  EXPECT_DOUBLE_EQ(sigma[1], 5.0);
  EXPECT_DOUBLE_EQ(sigma[2], 10.0);
}

TEST(Omnidirectional, DrivesStraightToTheWayPointWhileItTurns) {
  World world;
  world.name = "there_and_back";
  world.landmarks = {{5.0, 3.0}};
  world.waypoints = {{20.0, 0.0}, {0.0, 0.0}};
  const SimulatedDrive source(world,
                              {.noise = NoiseMode::matched,
                               .vehicle = Omnidirectional{},
                               .speed = 1.0,
                               .control = {.sigma = {0.1, 0.05, 0.05}},
                               .waypoint_radius = 0.3},
                              1);
  EXPECT_EQ(source.itinerary().moving_controls, 3U);
  Drive drive;
  source.generate(0, drive);
  for (const Control& control : drive.controls) {
    EXPECT_NEAR(std::hypot(control[0], control[1]), 1.0, 1e-12);
  }
  EXPECT_TRUE(std::ranges::any_of(drive.controls, [](const Control& c) { return c[0] < -0.9; }));
}

}  // namespace
}  // namespace montecarta::experiments
