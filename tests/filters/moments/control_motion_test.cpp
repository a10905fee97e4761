// SPDX-License-Identifier: BSD-3-Clause
#include "filters/moments/control_motion.hpp"

#include "filters/moments/motion_increment.hpp"
#include "filters/plain/sigma_points.hpp"
#include "tests/filters/moments/random_gaussians.hpp"
#include "tests/filters/some_models.hpp"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <cmath>

namespace montecarta::filters {
namespace {

using plain::blocks;
using plain::chol_in;
using plain::heading_first;
using plain::Vector;

/// A motion so far, a step to come, and the belief about both.
struct Case {
  MotionIncrement before;
  Control control;
  Belief belief;
  Vector<7> x = Vector<7>::Zero();
  Eigen::Matrix<double, 7, 7> S;

  explicit Case(RngStream& draw) {
    const Pose pose{draw.normal(), draw.normal(), wrap(7.0 * draw.normal())};
    before = {pose, random_pose_covariance(draw, 0.5, 0.2)};
    control = {5.0 * draw.normal(), 0.5 * draw.normal()};
    if (draw.uniform() < 0.5) {
      belief.vehicle = Car{Car::Kind::rear_wheel, 2.83, 0.76, 3.78, 0.5};
      control[1] *= 0.5;  // sampled angles stay below the one at which the wheel stands still
    }
    belief.control.sigma = {draw.uniform(), 0.3 * draw.uniform()};
    x.head<3>() << pose.x, pose.y, pose.heading;
    const Vector<2> Q(belief.control.sigma[0], belief.control.sigma[1]), R(0.3, 0.1);
    const Eigen::Matrix2d q = Q.asDiagonal(), r = R.asDiagonal();
    S = blocks({chol_in(heading_first(), symmetric(before.covariance())), q, r});
  }
  plain::Model model() const { return plain::motion_model(control, 0.4, belief.vehicle); }
};

void expect_near(const MotionIncrement& moved, const Vector<3>& mean, const Eigen::Matrix3d& P) {
  EXPECT_LT(boxminus(moved.pose(), plain::as_pose(mean)).norm(), 1e-13 * (1 + mean.norm()));
  EXPECT_LT((symmetric(moved.covariance()) - P).norm(), 1e-13 * (1 + P.norm()));
}

TEST(SigmaMotion, EqualsFifteenUnscentedPointsOfSevenDimensions) {
  RngStream draw({.seed = 82, .purpose = Draw::test});
  for (int n = 0; n < 500; ++n) {
    const Case c(draw);
    const auto image =
        plain::unscented(c.x, c.S, {.alpha = 0.9, .beta = 2.0, .kappa = -2.0}, c.model());
    expect_near(
        moved_by_sigma_points(c.before, c.control, 0.4, c.belief, unscented_rule(5, 0.9, 2, 0)),
        image.mean, image.covariance);
  }
}

TEST(SigmaMotion, EqualsFifteenCentralDifferencePointsOfSevenDimensions) {
  RngStream draw({.seed = 92, .purpose = Draw::test});
  const double h = std::sqrt(3.0);
  for (int n = 0; n < 500; ++n) {
    const Case c(draw);
    const auto image = plain::central_differences(c.x, c.S, h, c.model());
    expect_near(
        moved_by_sigma_points(c.before, c.control, 0.4, c.belief, central_difference_rule(h)),
        image.mean, image.A * image.A.transpose() + image.B * image.B.transpose());
  }
}

TEST(SigmaMotion, WithoutNoiseIsTheVehicleItself) {
  Belief sure;
  sure.control = {};
  const MotionIncrement moved = moved_by_sigma_points(MotionIncrement(), {3.0, 0.2}, 0.025, sure,
                                                      unscented_rule(5, 0.9, 2, 0));
  EXPECT_LT(boxminus(moved.pose(), move(Pose(), Control{3.0, 0.2}, 0.025, sure.vehicle)).norm(),
            1e-16);
  EXPECT_EQ(symmetric(moved.covariance()).norm(), 0.0);
}

TEST(QuadratureMotion, HasTheMomentsOfATremblingFrontAxle) {
  // (v + w)(cos(G + u), sin(G + u)) of normal w, u: E cos(G + u) = exp(-s^2 / 2) cos G.
  const Belief belief{.vehicle = {}, .control = {.sigma = {0.4, 0.07}}};
  const Control control{0.8, 0.3};
  const double duration = 0.1, s = belief.control.sigma[1];
  const double once = std::exp(-0.5 * s * s), twice = std::exp(-2.0 * s * s);
  const double square = control[0] * control[0] + belief.control.sigma[0] * belief.control.sigma[0];
  const Eigen::Vector2d mean =
      duration * control[0] * once * Eigen::Vector2d(std::cos(control[1]), std::sin(control[1]));
  const double c = twice * std::cos(2 * control[1]), d = twice * std::sin(2 * control[1]);
  Eigen::Matrix2d second;
  second << 0.5 * (1.0 + c), 0.5 * d, 0.5 * d, 0.5 * (1.0 - c);
  const Eigen::Matrix2d covariance =
      duration * duration * square * second - mean * mean.transpose();
  const MotionIncrement moved = moved_by_quadrature({}, control, duration, belief);
  // Three nodes err in the sixth power of the angle: 1e-9 of the step.
  EXPECT_NEAR(moved.pose().x, mean(0), 2e-10);
  EXPECT_NEAR(moved.pose().y, mean(1), 2e-10);
  EXPECT_NEAR(moved.pose().heading, mean(1) / std::get<Car>(belief.vehicle).wheelbase, 2e-10);
  const Eigen::Matrix3d found = symmetric(moved.covariance());
  EXPECT_LT((found.topLeftCorner<2, 2>() - covariance).norm(), 1e-9);
  EXPECT_NEAR(found(2, 2), covariance(1, 1) / std::pow(std::get<Car>(belief.vehicle).wheelbase, 2),
              1e-10);
  EXPECT_GT(covariance(1, 1), 1.2 * std::pow(duration * control[0] * s, 2))
      << "what a linearised step leaves out";
}

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

// The mean over controls measured again and again is the true displacement, and the covariance that
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
