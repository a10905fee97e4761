// SPDX-License-Identifier: BSD-3-Clause
// The moments of a step of every vehicle, against points that are all sent through it.
#include "filters/models/ackermann.hpp"
#include "filters/moments/control_motion.hpp"
#include "tests/filters/moments/random_gaussians.hpp"
#include "tests/filters/some_models.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace montecarta::filters {
namespace {

using Stacked = Eigen::VectorXd;
using Points = Eigen::MatrixXd;

class EveryVehicleMoments : public testing::TestWithParam<SomeVehicle> {
 protected:
  const SomeVehicle& some() const { return GetParam(); }
  Belief belief() const {
    Belief belief{.vehicle = some().vehicle};
    belief.control = {.sigma = some().deviations, .alpha = {0.01, 0.02, 1e-4, 0.03}};
    return belief;
  }
  Eigen::Index controls() const { return static_cast<Eigen::Index>(some().controls()); }
  /// The step of (pose, deviation of the controls), as seen from `origin`.
  Eigen::Vector3d image(const Stacked& x, const Control& control, const Pose& origin) const {
    Control noisy = control;
    for (Eigen::Index i = 0; i < controls(); ++i) noisy[static_cast<std::size_t>(i)] += x(3 + i);
    return boxminus(move(Pose{x(0), x(1), x(2)}, noisy, kDuration, some().vehicle), origin);
  }
  Stacked deviations(const Control& control) const {
    const auto sigma = deviations_of(belief().control, control, some().vehicle);
    return Eigen::Map<const Eigen::Vector3d>(sigma.data()).head(controls());
  }
  static constexpr double kDuration = 0.4;
};

/// The square root of a pose's covariance with the heading's column first.
Eigen::Matrix3d root_of(const Eigen::Matrix3d& P) {
  Eigen::PermutationMatrix<3> order(Eigen::Vector3i(1, 2, 0));  // x, y, heading to 1, 2, 0
  const Eigen::Matrix3d ordered = order * P * order.transpose();
  const Eigen::Matrix3d L = ordered.llt().matrixL();
  return order.transpose() * L;
}

TEST_P(EveryVehicleMoments, SigmaPointsAreThoseSentThroughTheVehicle) {
  RngStream draw({.seed = 71, .purpose = Draw::test});
  for (int n = 0; n < 100; ++n) {
    const Pose pose{draw.normal(), draw.normal(), wrap(7.0 * draw.normal())};
    const MotionIncrement before(pose, random_pose_covariance(draw, 0.5, 0.2));
    const Control control = some().any_control(draw, 1.0);
    const Eigen::Index dim = 3 + controls();
    const SigmaRule rule = unscented_rule(static_cast<double>(dim), 0.9, 2.0, 0.0);
    Points root = Points::Zero(dim, dim);
    root.topLeftCorner<3, 3>() = root_of(symmetric(before.covariance()));
    root.bottomRightCorner(controls(), controls()) = deviations(control).asDiagonal();
    Stacked x = Stacked::Zero(dim);
    x.head<3>() << pose.x, pose.y, pose.heading;
    const Pose origin = move(pose, control, kDuration, some().vehicle);
    Points points(3, 2 * dim);
    for (Eigen::Index k = 0; k < dim; ++k) {
      points.col(2 * k) = image(x + rule.spread * root.col(k), control, origin);
      points.col(2 * k + 1) = image(x - rule.spread * root.col(k), control, origin);
    }
    const double weight = 0.5 * rule.mean_weight;  // of a point; the centre's image is 0
    const Eigen::Vector3d mean = weight * points.rowwise().sum();
    const double w0 = 1.0 - weight * static_cast<double>(2 * dim);
    Eigen::Matrix3d P = (w0 + 1.0 - 0.81 + 2.0) * mean * mean.transpose();
    for (Eigen::Index k = 0; k < 2 * dim; ++k) {
      P += weight * (points.col(k) - mean) * (points.col(k) - mean).transpose();
    }
    const MotionIncrement moved = moved_by_sigma_points(before, control, kDuration, belief(), rule);
    EXPECT_LT((boxminus(moved.pose(), origin) - mean).norm(), 1e-12) << "case " << n;
    EXPECT_LT((symmetric(moved.covariance()) - P).norm(), 1e-12 * (1 + P.norm())) << "case " << n;
  }
}

TEST_P(EveryVehicleMoments, QuadratureIsThatOfAllControls) {
  // Three nodes in each control: exact where the step is linear in it, the same where it
  // turning_angles.
  const std::array<double, 3> nodes{0.0, std::sqrt(3.0), -std::sqrt(3.0)};
  const std::array<double, 3> weights{2.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0};
  RngStream draw({.seed = 72, .purpose = Draw::test});
  for (int n = 0; n < 100; ++n) {
    const Control control = some().any_control(draw, 1.0);
    const Stacked sigma = deviations(control);
    const Pose origin = move(Pose(), control, kDuration, some().vehicle);
    const int points = controls() == 2 ? 9 : 27;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
    for (int p = 0; p < points; ++p) {
      Stacked x = Stacked::Zero(3 + controls());
      double weight = 1.0;
      for (int i = 0, rest = p; i < controls(); ++i, rest /= 3) {
        x(3 + i) = nodes[static_cast<std::size_t>(rest % 3)] * sigma(i);
        weight *= weights[static_cast<std::size_t>(rest % 3)];
      }
      const Eigen::Vector3d y = image(x, control, origin);
      mean += weight * y;
      second += weight * y * y.transpose();
    }
    const MotionIncrement moved = moved_by_quadrature({}, control, kDuration, belief());
    const Eigen::Matrix3d P = second - mean * mean.transpose();
    EXPECT_LT((boxminus(moved.pose(), origin) - mean).norm(), 1e-13) << "case " << n;
    EXPECT_LT((symmetric(moved.covariance()) - P).norm(), 1e-13 * (1 + P.norm())) << "case " << n;
  }
}

TEST_P(EveryVehicleMoments, LinearisedIsWhatTheOthersAreWhereNoiseIsSmall) {
  Belief fine = belief();
  for (double& sigma : fine.control.sigma) sigma *= 1e-4;
  fine.control.alpha = {};
  MotionIncrement linear, sigma, averaged;
  for (int step = 0; step < 40; ++step) {
    const Control& control = step % 4 == 3 ? some().on_spot : some().typical;
    linear.advance(control, 0.025, fine);
    sigma = moved_by_sigma_points(sigma, control, 0.025, fine, central_difference_rule(1.7));
    averaged = moved_by_quadrature(averaged, control, 0.025, fine);
  }
  const Eigen::Matrix3d expected = symmetric(linear.covariance());
  for (const MotionIncrement& other : {sigma, averaged}) {
    EXPECT_LT(boxminus(other.pose(), linear.pose()).norm(), 1e-7);
    EXPECT_LT((symmetric(other.covariance()) - expected).norm(), 1e-5 * expected.norm());
  }
}

/// Every transform adds the noise of a step in the frame of the vehicle before it.
TEST_P(EveryVehicleMoments, HaveTheNoiseOfTheStep) {
  RngStream draw({.seed = 73, .purpose = Draw::test});
  const Pose pose{1.0, -2.0, 0.7};
  const MotionIncrement before(pose, random_pose_covariance(draw, 0.5, 0.2));
  const Control control = some().typical;
  for (const IncrementNoise& increment : some_increments()) {
    Belief noisy = belief();
    noisy.control.increment = increment;
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    turn.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(pose.heading).toRotationMatrix();
    Eigen::Matrix3d C = Eigen::Matrix3d::Zero();
    const auto step = body_step(noisy.vehicle, control, kDuration);
    for (const auto& [forward, left, angle] : increment_columns(increment, step, kDuration)) {
      const Eigen::Vector3d column(forward, left, angle);
      C += column * column.transpose();
    }
    const auto expect_added = [&](const MotionIncrement& with, const MotionIncrement& without) {
      EXPECT_LT(boxminus(with.pose(), without.pose()).norm(), 1e-12);
      const Eigen::Matrix3d added = symmetric(with.covariance()) - symmetric(without.covariance());
      EXPECT_LT((added - turn * C * turn.transpose()).norm(), 1e-12);
    };
    expect_added(moved_by_quadrature(before, control, kDuration, noisy),
                 moved_by_quadrature(before, control, kDuration, belief()));
    expect_added(moved_by_unbiased_controls(before, control, kDuration, noisy),
                 moved_by_unbiased_controls(before, control, kDuration, belief()));
    const SigmaRule rule = central_difference_rule(1.7);
    expect_added(moved_by_sigma_points(before, control, kDuration, noisy, rule),
                 moved_by_sigma_points(before, control, kDuration, belief(), rule));
    MotionIncrement with = before, without = before;
    with.advance(control, kDuration, noisy), without.advance(control, kDuration, belief());
    expect_added(with, without);
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryVehicleMoments, testing::ValuesIn(some_vehicles()),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace montecarta::filters
