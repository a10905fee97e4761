// SPDX-License-Identifier: BSD-3-Clause
// The laws of every vehicle.
#include "engine/random/stream.hpp"
#include "filters/models/ackermann.hpp"
#include "filters/models/eigen_jacobians.hpp"
#include "filters/models/vehicle.hpp"
#include "tests/filters/some_models.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

namespace montecarta::models {
namespace {

constexpr double kDuration = 0.1;

class EveryVehicle : public testing::TestWithParam<SomeVehicle> {
 protected:
  const Vehicle& vehicle() const { return GetParam().vehicle; }
  Pose any_pose() {
    return {10.0 * draw_.normal(), 10.0 * draw_.normal(), wrap(7.0 * draw_.normal())};
  }
  Control any_control() { return GetParam().any_control(draw_, 3.0); }
  RngStream draw_{{.seed = 61, .purpose = Draw::test}};
};

TEST_P(EveryVehicle, HasTheDerivativesOfItsMotion) {
  constexpr double h = 1e-5;
  for (int n = 0; n < 200; ++n) {
    const Pose pose = any_pose();
    const Control control = n == 0 ? GetParam().on_spot : any_control();
    const auto j = linearised_move(pose, control, kDuration, vehicle()).jacobians;
    const auto slope = [&](auto&& shifted) {
      return Eigen::Vector3d(boxminus(shifted(h), shifted(-h)) / (2.0 * h));
    };
    Eigen::Matrix3d Fx;
    Fx.setIdentity();
    Fx.col(2) = slope([&](double by) {
      return move(Pose{pose.x, pose.y, pose.heading + by}, control, kDuration, vehicle());
    });
    EXPECT_LT((pose_jacobian(j) - Fx).norm(), 1e-8) << "case " << n;
    const ControlJacobian Fu = control_jacobian(j);
    ASSERT_EQ(static_cast<std::size_t>(Fu.cols()), GetParam().controls());
    for (Eigen::Index i = 0; i < Fu.cols(); ++i) {
      const Eigen::Vector3d expected = slope([&](double by) {
        Control other = control;
        other[static_cast<std::size_t>(i)] += by;
        return move(pose, other, kDuration, vehicle());
      });
      EXPECT_LT((Fu.col(i) - expected).norm(), 1e-8) << "case " << n << ", control " << i;
    }
  }
}

TEST_P(EveryVehicle, LinearisedGoesWhereItGoes) {
  for (int n = 0; n < 200; ++n) {
    const Pose pose = any_pose();
    const Control control = any_control();
    const Pose linearised = linearised_move(pose, control, kDuration, vehicle()).pose;
    EXPECT_LT(boxminus(linearised, move(pose, control, kDuration, vehicle())).norm(), 1e-14);
  }
}

TEST_P(EveryVehicle, MovesInLanesAsAlone) {
  std::array<ControlOf<double>, kLanesOf<Lanes>> controls;
  ControlOf<Lanes> packed{};
  for (std::size_t lane = 0; lane < controls.size(); ++lane) {
    controls[lane] = lane == 0 ? GetParam().on_spot.values : any_control().values;
    for (std::size_t i = 0; i < controls[lane].size(); ++i) set(packed[i], lane, controls[lane][i]);
  }
  const BodyStep<Lanes> steps = body_step(vehicle(), packed, kDuration);
  for (std::size_t lane = 0; lane < controls.size(); ++lane) {
    const BodyStep<double> step = body_step(vehicle(), controls[lane], kDuration);
    EXPECT_NEAR(get(steps.forward, lane), step.forward, 1e-15);
    EXPECT_NEAR(get(steps.left, lane), step.left, 1e-15);
    EXPECT_NEAR(get(steps.turn, lane), step.turn, 1e-15);
  }
}

// The control that is found from a step makes the same step.
TEST_P(EveryVehicle, FindsTheControlOfAStep) {
  for (int n = 0; n < 200; ++n) {
    const Control control = GetParam().any_control(draw_, 1.0);
    const Control found =
        control_of(body_step(vehicle(), control, kDuration), kDuration, vehicle());
    for (std::size_t i = 0; i < GetParam().controls(); ++i) {
      EXPECT_NEAR(found[i], control[i], 1e-12) << "case " << n << ", control " << i;
    }
  }
}

// (1.6): where the vehicle is in the world does not matter.
TEST_P(EveryVehicle, TurnsAndShiftsWithTheWorld) {
  for (int n = 0; n < 200; ++n) {
    const Pose pose = any_pose(), start = any_pose();
    const auto in_other_world = [&](const Pose& p) -> Pose {
      const auto way = in_world(direction_of(start.heading), p.x, p.y);
      return {start.x + way.x, start.y + way.y, wrap(p.heading + start.heading)};
    };
    const Control control = any_control();
    const Pose expected = in_other_world(move(pose, control, kDuration, vehicle()));
    const Pose found = move(in_other_world(pose), control, kDuration, vehicle());
    EXPECT_LT(boxminus(found, expected).norm(), 1e-12);
  }
}

TEST_P(EveryVehicle, IsSteeredToAWayPointBehindIt) {
  constexpr double rate = 40.0;
  Pose pose;
  Control control;
  const Eigen::Vector2d goal(-20.0, 3.0);
  int steps = 0;
  const auto distance = [&] { return std::hypot(goal.x() - pose.x, goal.y() - pose.y); };
  for (; distance() > 1.0 && steps < 4000; ++steps) {
    const double course = std::atan2(goal.y() - pose.y, goal.x() - pose.x);
    control = steered(vehicle(), {control, course - pose.heading, 3.0, rate});
    EXPECT_FALSE(control.stands(moving_controls(controls_of(vehicle()))));
    pose = move(pose, control, 1.0 / rate, vehicle());
  }
  EXPECT_LT(distance(), 1.0);
}

TEST_P(EveryVehicle, IsFoundByItsNameAndNumbers) {
  std::map<std::string, double> asked;
  const auto nothing = [](const std::string&) { return std::nullopt; };
  const auto note = [&](const std::string& key) {
    return std::optional(
        asked.emplace(key, 1.5 + 0.25 * static_cast<double>(asked.size())).first->second);
  };
  const Vehicle found = vehicle_named(name_of(vehicle()), nothing, nothing).value();
  EXPECT_EQ(name_of(found), name_of(vehicle()));
  EXPECT_EQ(found.index(), vehicle().index());
  const Vehicle changed = vehicle_named(name_of(vehicle()), nothing, note).value();
  for_each_setting(changed, [&](const std::string& name, const auto& value) {
    if constexpr (std::is_same_v<std::decay_t<decltype(value)>, double>) {
      EXPECT_EQ(value, asked.at(name)) << name;
    }
  });
}

INSTANTIATE_TEST_SUITE_P(All, EveryVehicle, testing::ValuesIn(some_vehicles()),
                         [](const auto& instance) { return instance.param.name; });

TEST(Vehicles, AreAllInTheLaws) {
  std::set<std::string> tested;
  for (const SomeVehicle& one : some_vehicles()) tested.insert(name_of(one.vehicle));
  const std::vector<std::string> known = vehicle_names();
  EXPECT_EQ(tested, std::set<std::string>(known.begin(), known.end()));
}

TEST(Vehicles, AreNotFoundByAnotherName) {
  const auto nothing = [](const std::string&) { return std::nullopt; };
  EXPECT_FALSE(vehicle_named("hovercraft", nothing, nothing).has_value());
}

TEST(ControlOf, FindsNoSteeringInAVehicleThatStands) {
  const Control at_rest = control_of({0.0, 0.0, 0.0}, 0.1, Vehicle{});
  EXPECT_EQ(at_rest[0], 0.0);
  EXPECT_EQ(at_rest[1], 0.0);
}

}  // namespace
}  // namespace montecarta::models
