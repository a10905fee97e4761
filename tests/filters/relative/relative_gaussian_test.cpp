// SPDX-License-Identifier: BSD-3-Clause
#include "filters/relative/relative_gaussian.hpp"

#include "filters/relative/relative_chain.hpp"
#include "tests/filters/relative/some_chain.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace montecarta::filters {
namespace {

constexpr SensorNoise kFine{1e-8, 1e-10}, kRough{0.04, 4e-4};

/// A motion with noise of that scale.
MotionIncrement motion(double x, double y, double heading, double scale) {
  return {Pose{x, y, heading}, scale * Symmetric3<double>{4.0, 0.3, 1.0, 0.02, 0.03, 1e-2}};
}

/// Two landmarks seen from the start, one from the frame behind it, and the vehicle on its way.
RelativeGaussian gaussian_of(const SensorNoise& noise, double scale) {
  RelativeGaussian gaussian(noise);
  gaussian.start({1.0, 2.0, 0.5});
  gaussian.add_landmark({9.0, 0.4});
  gaussian.add_landmark({7.0, -0.8});
  gaussian.move(motion(4.0, 0.5, 0.3, scale));
  gaussian.add_frame();
  gaussian.add_landmark({6.0, 0.9});
  gaussian.move(motion(3.0, -0.5, -0.4, scale));
  return gaussian;
}

/// The expected ranges and bearings of all landmarks, as a function of the components.
Eigen::VectorXd expected_of(const RelativeGaussian& gaussian, const Eigen::VectorXd& x) {
  const RelativeChain& chain = gaussian.chain();
  VehicleInFrames vehicle;
  vehicle.linearise(chain, x, 0);
  Eigen::VectorXd all(2 * static_cast<Eigen::Index>(chain.landmarks.size()));
  for (std::size_t l = 0; l < chain.landmarks.size(); ++l) {
    const auto& first = chain.landmarks[l].first;
    all.segment<2>(2 * static_cast<Eigen::Index>(l)) =
        to_vector(predicted_observation(vehicle.in(first.frame), linearised_point(first, x).place));
  }
  return all;
}

Eigen::MatrixXd derivative_of(const RelativeGaussian& gaussian) {
  const Eigen::VectorXd& x = gaussian.mean();
  Eigen::MatrixXd H(expected_of(gaussian, x).size(), x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const Eigen::VectorXd way = 1e-6 * Eigen::VectorXd::Unit(x.size(), i);
    H.col(i) = (expected_of(gaussian, x + way) - expected_of(gaussian, x - way)) / 2e-6;
  }
  return H;
}

/// Sees all landmarks `by` deviations from where they are expected.
std::vector<RelativeGaussian::Seen> scan_of(const RelativeGaussian& gaussian,
                                            const SensorNoise& noise, double by) {
  const Eigen::VectorXd z = expected_of(gaussian, gaussian.mean());
  std::vector<RelativeGaussian::Seen> scan;
  for (Eigen::Index l = 0; 2 * l < z.size(); ++l) {
    scan.push_back({static_cast<std::size_t>(l),
                    {z(2 * l) + by * std::sqrt(noise.first),
                     z(2 * l + 1) - 0.5 * by * std::sqrt(noise.second)}});
  }
  return scan;
}

TEST(RelativeGaussian, IsConditionedAsByKalmanWhereAllIsLinear) {
  RelativeGaussian gaussian = gaussian_of(kFine, 1e-8);
  const Eigen::MatrixXd H = derivative_of(gaussian), P = gaussian.covariance();
  const Eigen::VectorXd x = gaussian.mean(), z = expected_of(gaussian, x);
  const auto scan = scan_of(gaussian, kFine, 0.7);
  const auto outcome = gaussian.see(scan, 20);
  const Eigen::VectorXd R = Eigen::Vector2d(kFine.first, kFine.second).replicate<3, 1>();
  const Eigen::MatrixXd S = H * P * H.transpose() + Eigen::MatrixXd(R.asDiagonal());
  Eigen::VectorXd v(6);
  for (const auto& [l, seen] : scan)
    v.segment<2>(2 * static_cast<Eigen::Index>(l)) =
        seen - z.segment<2>(2 * static_cast<Eigen::Index>(l));
  const Eigen::LLT<Eigen::MatrixXd> llt(S);
  const Eigen::MatrixXd K = llt.solve(H * P).transpose();
  EXPECT_FALSE(outcome.is_faulty);
  EXPECT_EQ(outcome.dof, 6U);
  EXPECT_NEAR(outcome.nis, v.dot(llt.solve(v)), 1e-5);
  EXPECT_NEAR(outcome.log_likelihood,
              -0.5 * (v.dot(llt.solve(v)) + 6.0 * std::log(kTwoPi) + std::log(S.determinant())),
              1e-4);
  EXPECT_LT((gaussian.mean() - x - K * v).norm(), 1e-4 * (K * v).norm());
  EXPECT_LT((gaussian.covariance() - P + K * S * K.transpose()).norm(), 1e-4 * P.norm());
}

// The minimum of the sum of squares, of which the gradient is zero.
TEST(RelativeGaussian, ComesToTheMinimumWhereItIsNotLinear) {
  RelativeGaussian gaussian = gaussian_of(kRough, 0.01);
  const Eigen::VectorXd before = gaussian.mean();
  const Eigen::MatrixXd P = gaussian.covariance();
  const auto scan = scan_of(gaussian, kRough, 6.0);
  ASSERT_FALSE(gaussian.see(scan, 50).is_faulty);
  const Eigen::VectorXd z = expected_of(gaussian, gaussian.mean());
  const Eigen::MatrixXd PH = P * derivative_of(gaussian).transpose();
  Eigen::VectorXd weighed(6);
  for (const auto& [l, seen] : scan) {
    const auto row = 2 * static_cast<Eigen::Index>(l);
    weighed(row) = (seen(0) - z(row)) / kRough.first;
    weighed(row + 1) = wrap(seen(1) - z(row + 1)) / kRough.second;
  }
  EXPECT_GT((gaussian.mean() - before).norm(), 0.5);
  EXPECT_LT((gaussian.mean() - before - PH * weighed).norm(), 0.01 * std::sqrt(P.trace()));
}

TEST(RelativeGaussian, JoiningALandmarkThatWasInitialisedAgainIsSeeingIt) {
  const RelativeGaussian gaussian = gaussian_of(kFine, 1e-8);
  const auto scan = scan_of(gaussian, kFine, 0.7);
  RelativeGaussian seen = gaussian, joined = gaussian;
  ASSERT_FALSE(seen.see(scan, 20).is_faulty);
  joined.add_frame();
  seen.add_frame();
  for (const auto& one : scan) joined.add_duplicate(one);
  EXPECT_TRUE(joined.has_duplicates());
  EXPECT_EQ(joined.point(0).frame, 2U);
  ASSERT_TRUE(joined.merge_duplicates(20));
  EXPECT_FALSE(joined.has_duplicates());
  EXPECT_EQ(joined.point(0).frame, 0U);
  ASSERT_EQ(joined.mean().size(), seen.mean().size());
  const Eigen::VectorXd sigma = seen.covariance().diagonal().cwiseSqrt();
  for (Eigen::Index i = 0; i < sigma.size(); ++i) {
    EXPECT_NEAR(joined.mean()(i), seen.mean()(i), 1e-2 * sigma(i) + 1e-12) << i;
    for (Eigen::Index j = 0; j < sigma.size(); ++j) {
      EXPECT_NEAR(joined.covariance()(i, j), seen.covariance()(i, j),
                  1e-3 * sigma(i) * sigma(j) + 1e-15);
    }
  }
}

TEST(RelativeGaussian, DroppingAFrameWithoutLandmarksKeepsThePlaces) {
  RelativeGaussian gaussian = gaussian_of(kFine, 1e-8);
  gaussian.add_frame();  // without landmarks
  gaussian.move(motion(2.0, 0.4, 0.2, 1e-8));
  gaussian.add_frame();
  gaussian.add_landmark({5.0, 0.1});
  const auto moments = [&] {
    std::vector<RelativeChain::Point> points;
    for (std::size_t l = 0; l < 4; ++l) points.push_back(gaussian.point(l));
    return ChainMoments().of(gaussian.chain(), gaussian.mean(), gaussian.covariance(), points);
  };
  const JointEstimate before = moments();
  ASSERT_TRUE(gaussian.drop_empty_frame());
  const JointEstimate after = moments();
  EXPECT_EQ(gaussian.chain().displacements.size(), 3U);
  EXPECT_LT((after.mean - before.mean).norm(), 1e-6);
  EXPECT_LT((after.covariance - before.covariance).norm(), 1e-5 * before.covariance.norm());
  EXPECT_FALSE(gaussian.drop_empty_frame()) << "all have landmarks";
}

TEST(RelativeGaussian, OfSeveralFramesWithoutLandmarksTheStraightestIsDropped) {
  RelativeGaussian gaussian(kFine);
  gaussian.start({});
  gaussian.add_landmark({9.0, 0.4});
  for (const double way : {2.0, 1.0, 9.0}) {
    gaussian.move(motion(way, 0.0, 0.0, 1e-4));
    gaussian.add_frame();
  }
  gaussian.add_duplicate({0, {5.0, 0.1}});  // in the newest frame, which so is not empty
  ASSERT_TRUE(gaussian.drop_empty_frame());
  ASSERT_EQ(gaussian.chain().displacements.size(), 3U);
  EXPECT_NEAR(displacement(gaussian.chain(), 0, gaussian.mean()).x, 3.0, 1e-12);
  EXPECT_NEAR(displacement(gaussian.chain(), 1, gaussian.mean()).x, 9.0, 1e-12);
  EXPECT_EQ(gaussian.point(0).frame, 2U);
}

TEST(RelativeGaussian, AWayBendsByTheVarianceOfTheHeadingAndItsLength) {
  const RelativeGaussian gaussian = gaussian_of(kRough, 0.01);
  std::vector<double> bends;
  gaussian.bends(bends);
  ASSERT_EQ(bends.size(), 2U);
  VehicleGaussian vehicle{.with_all = Eigen::MatrixXd::Zero(gaussian.mean().size(), 3)};
  double farthest = 0.0;
  for (std::size_t k = 2; k-- > 0;) {
    vehicle.become_that_in_frame(k, gaussian.chain(), gaussian.mean(), gaussian.covariance());
    farthest = std::max(
        farthest, std::sqrt(vehicle.pose.x * vehicle.pose.x + vehicle.pose.y * vehicle.pose.y));
    EXPECT_NEAR(bends[k], 0.5 * vehicle.covariance(2, 2) * farthest, 1e-12) << "frame " << k;
    EXPECT_GT(bends[k], 1e-5);
  }
}

TEST(RelativeGaussian, WhereJoiningFailsTheFirstCoordinatesAreForgotten) {
  RelativeGaussian gaussian = gaussian_of({-1.0, 4e-4}, 1e-8);
  gaussian.add_frame();
  const Eigen::Index rows = gaussian.mean().size();
  gaussian.add_duplicate({0, {5.0, 0.1}});
  EXPECT_FALSE(gaussian.merge_duplicates(20));
  EXPECT_FALSE(gaussian.has_duplicates());
  EXPECT_EQ(gaussian.mean().size(), rows);
  EXPECT_EQ(gaussian.point(0).frame, 2U);
  EXPECT_EQ(gaussian.mean()(gaussian.point(0).row), 5.0);
  EXPECT_EQ(gaussian.point(1).frame, 0U);
  EXPECT_EQ(gaussian.mean()(gaussian.point(1).row), 7.0);
}

TEST(RelativeGaussian, ALandmarkSeenAwayFromTheFrameIsWhereItIsSeen) {
  RelativeGaussian gaussian = gaussian_of(kRough, 1e-8);
  gaussian.add_landmark({5.0, 0.6});
  EXPECT_FALSE(gaussian.point(3).is_polar);
  const Eigen::VectorXd z = expected_of(gaussian, gaussian.mean());
  EXPECT_NEAR(z(6), 5.0, 1e-12);
  EXPECT_NEAR(z(7), 0.6, 1e-12);
  const Eigen::MatrixXd H = derivative_of(gaussian).bottomRows<2>();
  const Eigen::Matrix2d seen = H * gaussian.covariance() * H.transpose();
  EXPECT_NEAR(seen(0, 0), kRough.first, 1e-4 * kRough.first);
  EXPECT_NEAR(seen(1, 1), kRough.second, 1e-4 * kRough.second);
}

TEST(RelativeGaussian, TellsWhatIsExpectedOfAllLandmarks) {
  const RelativeGaussian gaussian = gaussian_of(kRough, 0.01);
  const Eigen::MatrixXd H = derivative_of(gaussian);
  const Eigen::VectorXd z = expected_of(gaussian, gaussian.mean());
  Eigen::MatrixXd S = H * gaussian.covariance() * H.transpose();
  S.diagonal() += Eigen::Vector2d(kRough.first, kRough.second).replicate<3, 1>();
  std::size_t told = 0;
  gaussian.expect_all(
      [&](std::size_t l, const Eigen::Vector2d& expected, const Eigen::Matrix2d& covariance) {
        const auto row = 2 * static_cast<Eigen::Index>(l);
        EXPECT_LT((expected - z.segment<2>(row)).norm(), 1e-12);
        EXPECT_LT((covariance - S.block<2, 2>(row, row)).norm(), 1e-7 * covariance.norm());
        ++told;
      });
  EXPECT_EQ(told, 3U);
}

TEST(RelativeGaussian, ADegenerateCovarianceIsAFaultAndChangesNothing) {
  RelativeGaussian gaussian = gaussian_of({-1.0, 4e-4}, 1e-8);
  const Eigen::VectorXd mean = gaussian.mean();
  const Eigen::MatrixXd P = gaussian.covariance();
  EXPECT_TRUE(gaussian.see(scan_of(gaussian, kRough, 1.0), 20).is_faulty);
  EXPECT_EQ(gaussian.mean(), mean);
  EXPECT_EQ(gaussian.covariance(), P);
}

}  // namespace
}  // namespace montecarta::filters
