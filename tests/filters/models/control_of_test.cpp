// SPDX-License-Identifier: BSD-3-Clause
#include "filters/models/control_of.hpp"

#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

namespace montecarta::models {
namespace {

// Whatever a control does, the same is done by the control that is found from it.
TEST(ControlOf, TurnsAStepRound) {
  const Car car{.wheelbase = 2.6};
  const Car ute{.kind = Car::Kind::rear_wheel,
                .wheelbase = 2.83,
                .wheel_left = 0.76,
                .sensor_ahead = 3.78,
                .sensor_left = 0.5};
  RngStream draw({.seed = 5});
  for (int i = 0; i < 200; ++i) {
    const double speed = 0.5 + 5.0 * draw.uniform(), steer = 1.2 * (draw.uniform() - 0.5);
    for (const Vehicle& vehicle : {Vehicle(car), Vehicle(ute)}) {
      const Control found =
          control_of(body_step(vehicle, Control{speed, steer}, 0.1), 0.1, vehicle);
      EXPECT_NEAR(found[0], speed, 1e-12);
      EXPECT_NEAR(found[1], steer, 1e-12);
    }
  }
}

TEST(ControlOf, FindsNoSteeringInAVehicleThatStands) {
  const Control at_rest = control_of({0.0, 0.0, 0.0}, 0.1, Vehicle{});
  EXPECT_EQ(at_rest[0], 0.0);
  EXPECT_EQ(at_rest[1], 0.0);
}

}  // namespace
}  // namespace montecarta::models
