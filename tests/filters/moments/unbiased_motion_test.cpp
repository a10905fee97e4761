// SPDX-License-Identifier: BSD-3-Clause
#include "filters/moments/control_motion.hpp"
#include "tests/filters/some_vehicles.hpp"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <cmath>

namespace montecarta::filters {
namespace {

TEST(UnbiasedMotion, HasTheClosedFormOfAFrontAxle) {
  const double s = 10.0 * kPi / 180.0;
  const Belief belief{.vehicle = {}, .control = {.sigma = {1.0, s}}};
  const Control control{3.0, 0.3};
  const double duration = 0.025, square = control[0] * control[0] - 1.0;
  const Eigen::Vector2d mean = duration * control[0] * std::exp(0.5 * s * s) *
                               Eigen::Vector2d(std::cos(control[1]), std::sin(control[1]));
  const double c = std::exp(2.0 * s * s) * std::cos(2 * control[1]);
  const double d = std::exp(2.0 * s * s) * std::sin(2 * control[1]);
  Eigen::Matrix2d second;
  second << 0.5 * (1.0 + c), 0.5 * d, 0.5 * d, 0.5 * (1.0 - c);
  const Eigen::Matrix2d P = mean * mean.transpose() - duration * duration * square * second;
  const MotionIncrement moved = moved_by_unbiased_controls({}, control, duration, belief);
  // The rule errs in the sixth power of the angle, and of twice the angle.
  EXPECT_NEAR(moved.pose().x, mean(0), 1e-5 * mean(0));
  EXPECT_NEAR(moved.pose().y, mean(1), 1e-5 * mean(0));
  EXPECT_NEAR(moved.pose().heading, mean(1) / 4.0, 1e-5 * mean(0));
  const Eigen::Matrix3d found = symmetric(moved.covariance());
  EXPECT_LT((found.topLeftCorner<2, 2>() - P).norm(), 0.01 * P.norm());
  EXPECT_NEAR(found(2, 2), P(1, 1) / 16.0, 0.01 * P(1, 1) / 16.0);
}

class EveryVehicleUnbiased : public testing::TestWithParam<SomeVehicle> {};

// Of controls measured again and again the mean is the true displacement, and the covariance that
// of the means: 20000 draws, five standard errors.
TEST_P(EveryVehicleUnbiased, HasTheTrueDisplacementAndItsErrorsCovarianceOnAverage) {
  const SomeVehicle& some = GetParam();
  Belief belief{.vehicle = some.vehicle};
  belief.control = {.sigma = {0.3, 0.15, 0.15}};
  if (some.controls() == 3) belief.control.sigma[1] = 0.3;
  const double duration = 1.0;
  const int n = 20000;
  const Eigen::Vector3d truth =
      boxminus(move(Pose(), some.typical, duration, some.vehicle), Pose());
  RngStream draw({.seed = 236, .purpose = Draw::test});
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero(), covariances = squares;
  for (int k = 0; k < n; ++k) {
    Control measured = some.typical;
    for (std::size_t i = 0; i < some.controls(); ++i) {
      measured[i] += belief.control.sigma[i] * draw.normal();
    }
    const MotionIncrement moved = moved_by_unbiased_controls({}, measured, duration, belief);
    const Eigen::Vector3d error = boxminus(moved.pose(), Pose()) - truth;
    sum += error;
    squares += error * error.transpose();
    covariances += symmetric(moved.covariance());
  }
  const Eigen::Matrix3d spread = squares / n;
  for (Eigen::Index i = 0; i < 3; ++i) {
    EXPECT_LE(std::abs(sum(i) / n), 5.0 * std::sqrt(spread(i, i) / n)) << "component " << i;
    // A sample variance has the relative standard error sqrt(2 / n); the estimate's own is alike.
    EXPECT_NEAR(covariances(i, i) / n, spread(i, i), 5.0 * std::sqrt(4.0 / n) * spread(i, i)) << i;
  }
}

TEST_P(EveryVehicleUnbiased, IsACovarianceHoweverSlowTheVehicle) {
  const SomeVehicle& some = GetParam();
  const Belief belief{.vehicle = some.vehicle, .control = {.sigma = some.deviations}};
  for (const double speed : {0.0, 0.01, 0.2, 0.3, 0.5, 5.0}) {
    Control control = some.typical;
    control[0] = speed;
    const MotionIncrement moved = moved_by_unbiased_controls({}, control, 0.1, belief);
    const Eigen::Matrix3d P = symmetric(moved.covariance());
    const Eigen::Vector3d eigenvalues =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(P).eigenvalues();
    EXPECT_GT(eigenvalues(0), -1e-12 * eigenvalues(2)) << "at " << speed << " m/s";
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryVehicleUnbiased, testing::ValuesIn(some_vehicles()),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace montecarta::filters
