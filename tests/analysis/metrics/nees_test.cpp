// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/nees.hpp"

#include "analysis/statistics/spread.hpp"
#include "engine/random/stream.hpp"
#include "tests/analysis/synthetic_runs.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace montecarta::analysis {
namespace {

TEST(Nees, EqualsTheQuadraticFormOfEachBlock) {
  RngStream draw({5, 0, 0, 0, Draw::test});
  for (int i = 0; i < 200; ++i) {
    const Eigen::Matrix3d root = Eigen::Matrix3d::NullaryExpr([&] { return draw.normal(); });
    const Eigen::Matrix3d P = root * root.transpose() + 0.01 * Eigen::Matrix3d::Identity();
    const Eigen::Vector3d e(draw.normal(), draw.normal(), draw.normal());
    const Eigen::Matrix2d position = P.topLeftCorner<2, 2>();
    const double expected = e.dot(P.llt().solve(e));
    EXPECT_NEAR(nees<3>(e, P).value, expected, 1e-9 * expected) << i;
    const double expected2 = e.head<2>().dot(position.llt().solve(e.head<2>()));
    EXPECT_NEAR(nees<2>(e, P).value, expected2, 1e-9 * expected2) << i;
    EXPECT_NEAR(nees<1>(e, P, 2).value, e(2) * e(2) / P(2, 2), 1e-9 * e(2) * e(2) / P(2, 2)) << i;
    EXPECT_EQ(nees<3>(e, P).rank, 3);
  }
}

// Law: of any dimension, and nothing of what is no covariance.
TEST(ImportedNees, EqualsTheQuadraticFormOrIsUnusable) {
  RngStream draw({6, 0, 0, 0, Draw::test});
  for (const Eigen::Index d : {1, 2, 6, 15}) {
    const Eigen::MatrixXd root = Eigen::MatrixXd::NullaryExpr(d, d, [&] { return draw.normal(); });
    Eigen::MatrixXd P = root * root.transpose() + 0.01 * Eigen::MatrixXd::Identity(d, d);
    const Eigen::VectorXd e = Eigen::VectorXd::NullaryExpr(d, [&] { return draw.normal(); });
    const double expected = e.dot(P.llt().solve(e));
    EXPECT_NEAR(imported_nees(e, P).value, expected, 1e-9 * expected);
    EXPECT_EQ(imported_nees(e, P).rank, d);
    EXPECT_NEAR(imported_nees(1e-9 * e, 1e-18 * P).value, expected, 1e-9 * expected) << "no floor";
    EXPECT_FALSE(imported_nees(e, -P).is_usable());
    if (d == 1) continue;
    Eigen::MatrixXd indefinite = Eigen::MatrixXd::Identity(d, d);
    indefinite(0, 1) = indefinite(1, 0) = 1.0 + 1e-6;
    EXPECT_FALSE(imported_nees(e, indefinite).is_usable());
    P(0, 1) += 1e-3 * std::sqrt(P(0, 0) * P(1, 1));
    EXPECT_FALSE(imported_nees(e, P).is_usable()) << "not symmetric";
    P(0, 1) = P(1, 0) = std::numeric_limits<double>::infinity();
    EXPECT_FALSE(imported_nees(e, P).is_usable());
  }
}

// After eight noisy steps the deviations along the axes are 14 mm, 8 mm and 0.07 mm (EQUATIONS 1).
TEST(Nees, AcceptsAThinCovariance) {
  const Eigen::Vector3d axes(0.0141, 0.0081, 7.3e-5);
  const Eigen::Matrix3d turn = Eigen::Quaterniond(0.9, 0.1, 0.3, 0.2).normalized().matrix();
  const Eigen::Matrix3d P = turn * axes.cwiseAbs2().asDiagonal() * turn.transpose();
  const Nees sample = nees<3>(turn * axes, P);
  EXPECT_NEAR(sample.value, 3.0, 1e-6);
  EXPECT_EQ(sample.rank, 3);
}

TEST(Nees, IsJudgedInTheRangeOfASingularCovariance) {
  const Eigen::Vector3d forward(1.0, 2.0, 0.1), left(-2.0, 1.0, 0.05);
  const Eigen::Matrix3d line = forward * forward.transpose();
  EXPECT_EQ(nees<3>(2.0 * forward, line).rank, 1);
  EXPECT_NEAR(nees<3>(2.0 * forward, line).value, 4.0, 1e-9);
  EXPECT_EQ(nees<2>(forward, line).rank, 1);
  EXPECT_EQ(nees<1>(forward, line, 2).rank, 1);
  const Eigen::Matrix3d plane = line + left * left.transpose();
  EXPECT_EQ(nees<3>(forward - 3.0 * left, plane).rank, 2);
  EXPECT_NEAR(nees<3>(forward - 3.0 * left, plane).value, 10.0, 1e-8);
  const Eigen::Matrix3d no_heading = Eigen::Vector3d(4.0, 1.0, 0.0).asDiagonal();
  EXPECT_EQ(nees<3>({2.0, 1.0, 0.0}, no_heading).rank, 2);
  EXPECT_NEAR(nees<3>({2.0, 1.0, 0.0}, no_heading).value, 2.0, 1e-12);
}

TEST(Nees, IsLargestWhereTheCovarianceExcludesTheError) {
  const Eigen::Matrix3d no_heading = Eigen::Vector3d(4.0, 1.0, 0.0).asDiagonal();
  EXPECT_EQ(nees<3>({2.0, 1.0, 1e-3}, no_heading).value, kLargestNees);
  EXPECT_EQ(nees<3>({1.0, 0.0, 0.0}, Eigen::Matrix3d::Zero()).value, kLargestNees);
  const Eigen::Vector3d forward(1.0, 2.0, 0.1);
  EXPECT_EQ(nees<3>({-20.0, 20.0, 0.0}, forward * forward.transpose()).value, kLargestNees);
  EXPECT_EQ(nees<3>({1e200, 0.0, 0.0}, Eigen::Matrix3d::Identity()).value, kLargestNees);
}

TEST(Nees, SaysNothingOfAnErrorThatIsKnownToBeZero) {
  const Nees sample = nees<3>(Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero());
  EXPECT_EQ(sample.rank, 0);
  EXPECT_TRUE(sample.is_usable());
  EXPECT_TRUE(std::isnan(on_full_scale(sample, 3)));
}

// STATISTICS (2.2): chi-square of two degrees of freedom becomes chi-square of three.
TEST(Nees, OfALowerRankIsPutOnTheScaleOfAllComponents) {
  EXPECT_NEAR(on_full_scale({1.386294361119891, 2}, 3), 2.365973884375338, 1e-9) << "medians";
  EXPECT_NEAR(on_full_scale({5.991464547107979, 2}, 3), 7.814727903251179, 1e-9) << "95 %";
  EXPECT_EQ(on_full_scale({1.7, 3}, 3), 1.7);
  const double last = on_full_scale({27.631021115928547, 2}, 3);  // once in a million
  EXPECT_NEAR(on_full_scale({27631.021115928547, 2}, 3), 1000.0 * last, 1e-6 * last);
}

TEST(Nees, IsUnusableWhereANumberIsMissing) {
  const Eigen::Matrix3d P = SyntheticStudy::covariance();
  EXPECT_FALSE(nees<3>({kNaN, 0.0, 0.0}, P).is_usable());
  Eigen::Matrix3d broken = P;
  broken(2, 2) = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(nees<3>({0.1, 0.1, 0.1}, broken).is_usable());
  EXPECT_NEAR(nees<2>({0.2, 0.0, 0.0}, broken).value, nees<2>({0.2, 0.0, 0.0}, P).value, 1e-12);
}

TEST(Nees, IsUnusableWhereACovarianceIsIndefinite) {
  const Eigen::Matrix3d P = Eigen::Vector3d(1.0, -1.0, 1.0).asDiagonal();
  EXPECT_FALSE(nees<3>({0.1, 0.1, 0.1}, P).is_usable());
  Eigen::Matrix3d beyond = Eigen::Matrix3d::Identity();
  beyond(0, 1) = beyond(1, 0) = 1.1;
  EXPECT_FALSE(nees<3>({0.1, 0.1, 0.1}, beyond).is_usable());
  Eigen::Matrix3d hidden = Eigen::Vector3d(1.0, 0.0, 1.0).asDiagonal();
  hidden(0, 1) = hidden(1, 0) = 0.5;
  EXPECT_FALSE(nees<3>({0.1, 0.0, 0.1}, hidden).is_usable());
}

/// Mean NEES, with its standard error, of the covariance of `particles` equal draws of a Gaussian
/// that the truth is one more draw of.
Summary mean_nees_of_draws(int particles, int samples) {
  RngStream draw({11, 0, 0, 0, Draw::test});
  SummaryOf summary;
  for (int i = 0; i < samples; ++i) {
    const Eigen::Matrix3Xd poses =
        Eigen::Matrix3Xd::NullaryExpr(3, particles, [&] { return draw.normal(); });
    const Eigen::Vector3d mean = poses.rowwise().mean();
    const Eigen::Matrix3Xd centred = poses.colwise() - mean;
    const Eigen::Matrix3d P = centred * centred.transpose() / particles;
    const Eigen::Vector3d truth(draw.normal(), draw.normal(), draw.normal());
    summary.add(nees<3>(truth - mean, P).value);
  }
  return summary.result();
}

// STATISTICS 4: even a perfect filter of M particles has d (M + 1) / (M - d - 2) by the spread.
TEST(Nees, OfAParticleCloudHasHotellingsMean) {
  for (const int particles : {20, 30, 100}) {
    const Summary found = mean_nees_of_draws(particles, 10'000);
    const double expected = ideal_spread_nees(3, static_cast<std::size_t>(particles));
    EXPECT_NEAR(found.mean, expected, 5.0 * found.standard_error()) << particles;
    EXPECT_LT(found.standard_error(), 0.02 * expected);
  }
  EXPECT_DOUBLE_EQ(ideal_spread_nees(3, 10), 6.6);  // STATISTICS 4
  EXPECT_TRUE(std::isinf(ideal_spread_nees(3, 5)));
}

}  // namespace
}  // namespace montecarta::analysis
