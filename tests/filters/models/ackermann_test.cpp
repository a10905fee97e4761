// SPDX-License-Identifier: BSD-3-Clause
#include "filters/models/ackermann.hpp"

#include "engine/random/stream.hpp"
#include "filters/models/eigen_jacobians.hpp"
#include "filters/models/vehicle.hpp"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

namespace montecarta::models {
namespace {

constexpr double kDuration = 0.025;

/// The benchmark's, and the car of both recorded drives.
const Car kFront;
const Car kCar{.kind = Car::Kind::rear_wheel,
               .wheelbase = 2.83,
               .wheel_left = 0.76,
               .sensor_ahead = 3.78,
               .sensor_left = 0.5};

struct Case {
  Pose pose;
  Control control;
  Vehicle vehicle;
};

Case random_case(RngStream& draw) {
  return {{10.0 * draw.normal(), 10.0 * draw.normal(), wrap(7.0 * draw.normal())},
          {3.0 * draw.normal(), 0.3 * draw.normal()},
          draw.uniform() < 0.5 ? kFront : kCar};
}

Pose moved(const Case& c) { return move(c.pose, c.control, kDuration, c.vehicle); }

TEST(Ackermann, DrivesSidewaysByTheSineOfCourse) {
  // Ankishan eq. (38) prints cos in both rows; with heading 90 degrees that would stand still in y.
  const Pose there = move(Pose{0.0, 0.0, kPi / 2.0}, Control{2.0, 0.0}, 0.5, kFront);
  EXPECT_NEAR(there.x, 0.0, 1e-15);
  EXPECT_NEAR(there.y, 1.0, 1e-15);
}

TEST(Ackermann, TheCarMovesAsItsModelIsPublished) {
  RngStream draw({.seed = 24, .purpose = Draw::test});
  const double L = kCar.wheelbase, H = kCar.wheel_left;
  const double a = kCar.sensor_ahead, b = kCar.sensor_left;
  for (int n = 0; n < 200; ++n) {
    Case c = random_case(draw);
    c.vehicle = kCar;
    const double T = std::tan(c.control[1]), phi = c.pose.heading;
    const double v = c.control[0] / (1.0 - H / L * T);
    const double sine = std::sin(phi), cosine = std::cos(phi);
    const Eigen::Vector3d expected(kDuration * (v * cosine - v / L * T * (a * sine + b * cosine)),
                                   kDuration * (v * sine + v / L * T * (a * cosine - b * sine)),
                                   kDuration * v / L * T);
    EXPECT_LT((boxminus(moved(c), c.pose) - expected).norm(), 1e-13) << "case " << n;
  }
}

TEST(Ackermann, TheWheelAboutWhichTheCarTurnsSaysNothingOfIt) {
  const double pole = std::atan(kCar.wheelbase / kCar.wheel_left);
  for (const double steer : {pole - 1e-3, pole, pole + 1e-3}) {
    EXPECT_TRUE(is_beyond_model(kCar, {1.0, steer}));
    const Case c{{}, {1.0, steer}, kCar};
    EXPECT_LT(boxminus(moved(c), c.pose).norm(), 1.5);  // ten times the way, turning by 19 deg
  }
  EXPECT_FALSE(is_beyond_model(kCar, {1.0, 1.2}));
  EXPECT_FALSE(is_beyond_model(kFront, {1.0, pole}));
}

TEST(Ackermann, BothVehiclesAreOneWhereTheirPointsAreTheSame) {
  RngStream draw({.seed = 25, .purpose = Draw::test});
  const Car same{.kind = Car::Kind::rear_wheel, .wheelbase = 4.0, .sensor_ahead = 4.0};
  for (int n = 0; n < 200; ++n) {
    const Case c = random_case(draw);
    const double of_rear_axle = c.control[0] * std::cos(c.control[1]);
    const Pose by_rear = move(c.pose, {of_rear_axle, c.control[1]}, kDuration, same);
    const Pose by_front = move(c.pose, c.control, kDuration, kFront);
    EXPECT_LT(boxminus(by_rear, by_front).norm(), 1e-13) << "case " << n;
  }
}

/// Standard deviations [m, m, ~rad] along the principal axes after `steps` straight steps, largest
/// first.
Eigen::Vector3d deviations_after(int steps) {
  const Eigen::DiagonalMatrix<double, 2> Q(0.2 * 0.2, std::pow(2.0 * kPi / 180.0, 2));
  Pose pose;
  Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
  for (int k = 0; k < steps; ++k) {
    const auto step = linearised_move(pose, Control{3.0, 0.0}, kDuration, kFront);
    const Eigen::Matrix3d Fx = pose_jacobian(step.jacobians);
    const Matrix32 Fu = control_jacobian(step.jacobians);
    P = Fx * P * Fx.transpose() + Fu * Q * Fu.transpose();
    pose = step.pose;
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(P)
      .eigenvalues()
      .reverse()
      .cwiseMax(0.0)
      .cwiseSqrt();
}

TEST(Ackermann, NoiseOfEightStepsIsAsThinAsMeasured) {
  const Eigen::Vector3d after_8 = deviations_after(8);
  EXPECT_NEAR(after_8(0), 14.1e-3, 0.05e-3);
  EXPECT_NEAR(after_8(1), 8.1e-3, 0.05e-3);
  EXPECT_NEAR(after_8(2), 0.073e-3, 0.0005e-3);
  EXPECT_NEAR(deviations_after(2)(2), 8.3e-6, 0.05e-6);
  EXPECT_LT(deviations_after(1)(2), 1e-9);
}

const DifferentialDrive kArc;
const DifferentialDrive kEuler{.integration = Integration::euler};

TEST(DifferentialDrive, DrivesACircle) {
  // 2 m/s at 0.5 rad/s: a circle of radius 4 m, of which a step of pi seconds is a quarter.
  const BodyStep<double> step = body_step(kArc, Control{2.0, 0.5}, kPi);
  EXPECT_NEAR(step.forward, 4.0, 1e-14);
  EXPECT_NEAR(step.left, 4.0, 1e-14);
  EXPECT_NEAR(step.turn, kPi / 2, 1e-15);
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
    const auto below = mean_direction_by_turn(turning_angle_of(turn * (1 - 1e-12)));
    const auto above = mean_direction_by_turn(turning_angle_of(turn * (1 + 1e-12)));
    EXPECT_NEAR(below.along, above.along, 1e-12);
    EXPECT_NEAR(below.across, above.across, 1e-12);
  }
  for (const double turn : {1e-300, 1e-12, -1e-8}) {
    const auto [along, across] = mean_direction(turning_angle_of(turn));
    EXPECT_DOUBLE_EQ(across, turn / 2) << turn;
    EXPECT_NEAR(along, 1.0, 1e-10);
  }
  const auto [along, across] = mean_direction(turning_angle_of(0.0));
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
