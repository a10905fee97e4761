// SPDX-License-Identifier: BSD-3-Clause
#include "filters/models/ackermann.hpp"

#include "engine/random/stream.hpp"
#include "filters/models/eigen_jacobians.hpp"

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

}  // namespace
}  // namespace montecarta::models
