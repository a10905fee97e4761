// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/retraction.hpp"

#include "engine/random/stream.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <limits>

namespace montecarta::filters {
namespace {

TEST(Retraction, TheExponentialIsTheSumOfManySmallTurns) {
  for (const double turn : {-2.0, -1e-5, 0.0, 3e-4, 0.7}) {
    Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
    constexpr int kParts = 2000;
    for (int k = 0; k < kParts; ++k) {
      sum += Eigen::Rotation2Dd(turn * (k + 0.5) / kParts).toRotationMatrix() / kParts;
    }
    EXPECT_LT((exponential_jacobian(turn) - sum).norm(), 1e-6) << turn;
    const Eigen::Matrix2d R = Eigen::Rotation2Dd(turn).toRotationMatrix();
    EXPECT_LT((turn * exponential_jacobian(turn) * quarter_turn() - R + Eigen::Matrix2d::Identity())
                  .norm(),
              1e-15)
        << turn;
  }
}

/// A pose and two landmarks.
constexpr Eigen::Index kSize = 7;
using Vector7 = Eigen::Matrix<double, kSize, 1>;
using Matrix7 = Eigen::Matrix<double, kSize, kSize>;
const std::vector<Eigen::Index> kPointRows{0, 3, 5};

Vector7 random_mean(RngStream& draw) {
  return Vector7::NullaryExpr([&](Eigen::Index) { return 20.0 * draw.normal(); });
}

/// A Gaussian with this standard deviation of the heading [rad].
Matrix7 covariance_with(double sigma_heading, RngStream& draw) {
  const Matrix7 S = Matrix7::NullaryExpr([&](Eigen::Index) { return draw.normal(); });
  Matrix7 P = S * S.transpose();
  const double scale = sigma_heading / std::sqrt(P(2, 2));
  P.row(2) *= scale;
  P.col(2) *= scale;
  return P;
}

/// exp(xi) mean, the turn of the plane about `origin`.
Vector7 retracted(const Vector7& mean, const Vector7& xi, const Eigen::Vector2d& origin) {
  Vector7 moved = mean;
  moved(2) += xi(2);
  const Eigen::Matrix2d R = Eigen::Rotation2Dd(xi(2)).toRotationMatrix();
  const Eigen::Matrix2d V = exponential_jacobian(xi(2));
  for (const Eigen::Index row : kPointRows) {
    moved.segment<2>(row) = origin + R * (mean.segment<2>(row) - origin) + V * xi.segment<2>(row);
  }
  return moved;
}

struct Moments7 {
  Vector7 mean;
  Matrix7 covariance;
};

/// It sums over 2000 nodes of the turn and is exact given the turn: the points are linear in the
/// rest of xi.
Moments7 by_many_nodes(const Vector7& mean, const Matrix7& P, const Eigen::Vector2d& origin) {
  Matrix7 T = Matrix7::Identity();  // xi = T e: EQUATIONS (15.3) about the origin
  for (const Eigen::Index row : kPointRows) {
    T.block<2, 1>(row, 2) = -quarter_turn() * (mean.segment<2>(row) - origin);
  }
  const Matrix7 X = T * P * T.transpose();
  const double sigma = std::sqrt(X(2, 2));
  const Vector7 regression = X.col(2) / X(2, 2);
  const Matrix7 rest = X - regression * regression.transpose() * X(2, 2);
  Moments7 sum{Vector7::Zero(), Matrix7::Zero()};
  double weights = 0.0;
  for (int i = -1000; i <= 1000; ++i) {
    const double z = 0.01 * i, weight = std::exp(-0.5 * z * z);
    const Vector7 at = retracted(mean, regression * (sigma * z), origin);
    Matrix7 V = Matrix7::Identity();
    for (const Eigen::Index row : kPointRows) {
      V.block<2, 2>(row, row) = exponential_jacobian(sigma * z);
    }
    weights += weight;
    sum.mean += weight * at;
    sum.covariance += weight * (at * at.transpose() + V * rest * V.transpose());
  }
  const Vector7 average = sum.mean / weights;
  return {average, sum.covariance / weights - average * average.transpose()};
}

TEST(PushedMoments, AreThoseOfTheInvariantChartWhereverItsOriginLies) {
  RngStream draw({.seed = 231, .purpose = Draw::test});
  for (const double sigma : {1e-3, 0.1, 0.5}) {
    const Vector7 mean = random_mean(draw);
    const Matrix7 P = covariance_with(sigma, draw);
    Eigen::VectorXd pushed_mean = mean;
    Eigen::MatrixXd pushed_covariance = P;
    push_moments(pushed_mean, pushed_covariance);
    for (const Eigen::Vector2d& origin : {Eigen::Vector2d(0, 0), Eigen::Vector2d(-35, 12)}) {
      const Moments7 expected = by_many_nodes(mean, P, origin);
      EXPECT_LT((pushed_mean - expected.mean).norm(), 1e-9) << sigma;
      EXPECT_LT((pushed_covariance - expected.covariance).norm(), 1e-7 * P.norm()) << sigma;
    }
  }
}

TEST(PushedMoments, OfAPoseAndOfALandmarkArePartsOfTheWhole) {
  RngStream draw({.seed = 232, .purpose = Draw::test});
  const Vector7 mean = random_mean(draw);
  const Matrix7 P = covariance_with(0.3, draw);
  Eigen::VectorXd whole = mean;
  Eigen::MatrixXd covariance = P;
  push_moments(whole, covariance);
  const PoseMoments pose = pushed({{mean(0), mean(1), mean(2)}, P.topLeftCorner<3, 3>()});
  EXPECT_LT((pose.covariance - covariance.topLeftCorner<3, 3>()).norm(), 1e-12);
  EXPECT_NEAR(pose.mean.x, whole(0), 1e-12);
  EXPECT_NEAR(pose.mean.y, whole(1), 1e-12);
  PointMoments point{mean.segment<2>(5), P.block<2, 3>(5, 0), P.block<2, 2>(5, 5)};
  const LandmarkEstimate landmark = pushed(point, P(2, 2));
  EXPECT_LT((landmark.covariance - covariance.block<2, 2>(5, 5)).norm(), 1e-12);
  EXPECT_LT((landmark.mean - whole.segment<2>(5)).norm(), 1e-12);
}

TEST(PushedMoments, AreTheGaussiansOwnWhereTheHeadingIsCertain) {
  RngStream draw({.seed = 233, .purpose = Draw::test});
  Eigen::VectorXd mean = random_mean(draw);
  Eigen::MatrixXd P = covariance_with(0.0, draw);
  const Eigen::VectorXd mean_before = mean;
  const Eigen::MatrixXd before = P;
  push_moments(mean, P);
  EXPECT_EQ(mean, mean_before);
  EXPECT_EQ(P, before);
}

TEST(PushedMoments, LeaveALandmarkNeverSeenUnknown) {
  RngStream draw({.seed = 234, .purpose = Draw::test});
  Eigen::VectorXd mean = random_mean(draw);
  Eigen::MatrixXd P = covariance_with(0.2, draw);
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  mean.segment<2>(3).setConstant(unknown);
  P.middleRows<2>(3).setConstant(unknown);
  P.middleCols<2>(3).setConstant(unknown);
  push_moments(mean, P);
  EXPECT_TRUE(mean.segment<2>(3).array().isNaN().all());
  EXPECT_TRUE(mean.segment<2>(5).allFinite());
  EXPECT_TRUE((P.block<2, 2>(5, 5).allFinite()));
  EXPECT_TRUE((P.block<2, 2>(5, 3).array().isNaN().all()));
}

}  // namespace
}  // namespace montecarta::filters
