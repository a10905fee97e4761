// SPDX-License-Identifier: BSD-3-Clause
#include "filters/models/ackermann.hpp"
#include "filters/models/vehicle.hpp"

#include <gtest/gtest.h>

namespace montecarta::models {
namespace {

const DifferentialDrive kArc;
const DifferentialDrive kEuler{.integration = Integration::euler};

TEST(DifferentialDrive, DrivesACircle) {
  // 2 m/s at 0.5 rad/s: a circle of radius 4 m, of which a step of pi seconds is a quarter.
  const BodyStep<double> step = body_step(kArc, Control{2.0, 0.5}, kPi);
  EXPECT_NEAR(step.forward, 4.0, 1e-14);
  EXPECT_NEAR(step.left, 4.0, 1e-14);
  EXPECT_NEAR(step.turn, kPi / 2, 1e-15);
}

TEST(DifferentialDrive, DrivesAWholeCircleBackToWhereItWas) {
  const BodyStep<double> step = body_step(kArc, Control{2.0, 0.5}, 4 * kPi);
  EXPECT_NEAR(step.forward, 0.0, 1e-14);
  EXPECT_NEAR(step.left, 0.0, 1e-14);
}

TEST(DifferentialDrive, TurnsOnTheSpot) {
  for (const DifferentialDrive& vehicle : {kArc, kEuler}) {
    const Pose there = move(Pose{1.0, 2.0, 3.0}, Control{0.0, 1.5}, 0.2, vehicle);
    EXPECT_EQ(there.x, 1.0);
    EXPECT_EQ(there.y, 2.0);
    EXPECT_NEAR(there.heading, wrap(3.3), 1e-15);
  }
}

TEST(DifferentialDrive, ByEulerKeepsTheHeadingOfTheBeginning) {
  const BodyStep<double> step = body_step(kEuler, Control{2.0, 0.5}, 0.1);
  EXPECT_EQ(step.forward, 0.2);
  EXPECT_EQ(step.left, 0.0);
  EXPECT_EQ(step.turn, 0.05);
}

TEST(DifferentialDrive, OfManyEulerStepsIsTheArc) {
  Pose arc = move(Pose(), Control{2.0, 0.5}, 1.0, kArc), steps;
  for (int k = 0; k < 100'000; ++k) steps = move(steps, Control{2.0, 0.5}, 1e-5, kEuler);
  EXPECT_LT(boxminus(arc, steps).norm(), 1e-5);
}

// Series and closed form agree where one gives way to the other; digits are kept below.
TEST(MeanDirection, IsSmoothAtSmallTurns) {
  for (const double turn : {1e-3, -1e-3}) {
    const auto below = mean_direction_by_turn(bend_of(turn * (1 - 1e-12)));
    const auto above = mean_direction_by_turn(bend_of(turn * (1 + 1e-12)));
    EXPECT_NEAR(below.along, above.along, 1e-12);
    EXPECT_NEAR(below.across, above.across, 1e-12);
  }
  for (const double turn : {1e-300, 1e-12, -1e-8}) {
    const auto [along, across] = mean_direction(bend_of(turn));
    EXPECT_DOUBLE_EQ(across, turn / 2) << turn;
    EXPECT_NEAR(along, 1.0, 1e-10);
  }
  const auto [along, across] = mean_direction(bend_of(0.0));
  EXPECT_EQ(along, 1.0);
  EXPECT_EQ(across, 0.0);
}

TEST(ControlNoise, GrowsWithTheMotion) {
  const ControlNoise noise{.sigma = {0.3, 0.1}, .alpha = {0.04, 0.5, 0.01, 0.09}};
  const auto sigma = deviations_of(noise, {2.0, 0.5}, kArc);
  EXPECT_DOUBLE_EQ(sigma[0], std::sqrt(0.09 + 0.04 * 4.0 + 0.5 * 0.25));
  EXPECT_DOUBLE_EQ(sigma[1], std::sqrt(0.01 + 0.01 * 4.0 + 0.09 * 0.25));
  const auto still = deviations_of(noise, {0.0, 0.0}, kArc);
  EXPECT_DOUBLE_EQ(still[0], 0.3);
  EXPECT_DOUBLE_EQ(still[1], 0.1);
}

}  // namespace
}  // namespace montecarta::models
