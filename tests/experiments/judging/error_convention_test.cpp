// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/error_convention.hpp"

#include "tests/experiments/judging/drawn_errors.hpp"

#include <gmock/gmock.h>

namespace montecarta::experiments {
namespace {

using testing::HasSubstr;

// Law: the error of a mean that was moved by an error is that error.
TEST(ErrorConvention, FindsTheErrorThatMovedTheMean) {
  RngStream draw({11, 0, 0, 0, Draw::test});
  for (const StateShape& shape : {plane_shape(), space_shape()}) {
    for (const ErrorConvention convention : conventions_of(shape.kind)) {
      for (int k = 0; k < 100; ++k) {
        const Eigen::VectorXd truth = drawn_truth(shape, draw);
        const double size = k % 3 == 0 ? 1e-7 : 1.0;
        const Eigen::VectorXd error = size * drawn_error(some_covariance(shape), draw);
        const Eigen::VectorXd mean = mean_with_error(shape, convention, truth, error);
        const Eigen::VectorXd found = error_of(shape, convention, mean, truth);
        EXPECT_LT((found - error).norm(), 1e-12)
            << name_of(convention) << " " << name_of(shape.kind);
      }
    }
  }
}

// A turn by half a circle, and either sign of a quaternion.
TEST(ErrorConvention, KnowsTheShorterWayRound) {
  Eigen::VectorXd truth(7), mean(7);
  truth << 1, 2, 3, 0, 0, 0, 1;
  mean << 1, 2, 3, 0, 0, std::sin(1.5), std::cos(1.5);
  const Eigen::VectorXd error = error_of(space_shape(), ErrorConvention::world, mean, truth);
  EXPECT_NEAR(error(5), 3.0, 1e-12);
  mean.tail<4>() *= -1.0;
  EXPECT_LT((error_of(space_shape(), ErrorConvention::world, mean, truth) - error).norm(), 1e-12);
  const Eigen::Vector3d there(0, 0, 3.1), back(0, 0, -3.1);
  EXPECT_NEAR(error_of(plane_shape(), ErrorConvention::world, there, back)(2), 6.2 - 2.0 * kPi,
              1e-12);
}

TEST(ErrorConvention, OfAVectorWrapsAnglesOnly) {
  const StateShape shape{StateKind::vector, {"a_rad", "b_m"}, {"a", "b"}, {"rad", "m"}};
  const Eigen::Vector2d error =
      error_of(shape, ErrorConvention::world, Eigen::Vector2d(3, 9), Eigen::Vector2d(-3, 0));
  EXPECT_NEAR(error(0), 6.0 - 2.0 * kPi, 1e-12);
  EXPECT_EQ(error(1), 9.0);
  EXPECT_EQ(conventions_of(StateKind::vector).size(), 1U);
}

// Law: to first order the covariance in the map is that of mean - truth.
TEST(ErrorConvention, TurnsCovariancesIntoTheMap) {
  RngStream draw({12, 0, 0, 0, Draw::test});
  for (const ErrorConvention convention : conventions_of(StateKind::pose)) {
    const Eigen::Vector3d mean = drawn_truth(plane_shape(), draw);
    Eigen::Matrix3d jacobian;  // of mean - truth by the error, around 0, at this mean
    constexpr double kStep = 1e-6;
    for (int c = 0; c < 3; ++c) {
      const Eigen::VectorXd error = kStep * Eigen::Vector3d::Unit(c);
      const Eigen::VectorXd moved = mean_with_error(plane_shape(), convention, mean, error);
      jacobian.col(c) =
          error_of(plane_shape(), ErrorConvention::world, moved, mean).head<3>() / kStep;
    }
    const Eigen::Matrix3d P = some_covariance(plane_shape());
    const Eigen::Matrix3d expected = jacobian * P * jacobian.transpose();
    EXPECT_LT((covariance_in_map(convention, mean, P) - expected).norm(), 1e-4 * expected.norm())
        << name_of(convention);
  }
}

TEST(ErrorConvention, IsExplained) {
  for (const ErrorConvention convention : conventions_of(StateKind::pose))
    EXPECT_THAT(explained_conventions(), HasSubstr(name_of(convention)));
}

}  // namespace
}  // namespace montecarta::experiments
