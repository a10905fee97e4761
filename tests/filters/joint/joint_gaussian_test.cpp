// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/joint_gaussian.hpp"

#include "filters/joint/joint_filter.hpp"
#include "filters/plain/ekf_slam.hpp"
#include "tests/filters/small_world.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace montecarta::filters {
namespace {

const Belief kRough{
    .vehicle = {}, .control = {.sigma = {1.0, 0.2}}, .sigma_range = 0.3, .sigma_bearing = 0.05};
const std::vector<Detection> kFirstScan{{8.0, 0.9, 0}, {12.0, -0.7, 1}, {6.0, -1.2, 2}};

/// The same drive for both: out, three landmarks, and on.
JointGaussian driven(Retraction retraction) {
  JointGaussian gaussian(kRough, retraction, 3);
  gaussian.start({1.0, 2.0, 0.5});
  MotionIncrement motion;
  for (int step = 0; step < 40; ++step) motion.advance({3.0, 0.2}, 0.025, kRough);
  gaussian.move(motion);
  for (const Detection& detection : kFirstScan) gaussian.append(vector_of(detection));
  gaussian.move(motion);
  return gaussian;
}

plain::EkfSlam textbook_driven() {
  plain::EkfSlam textbook(
      {.belief = kRough, .association = {}, .options = FilterOptions({}), .landmarks = 3});
  const StepContext context(1, 0, 0, Parallel::serial());
  textbook.start({1.0, 2.0, 0.5});
  for (int step = 0; step < 40; ++step) textbook.predict(context, {3.0, 0.2}, 0.025);
  textbook.update(context, kFirstScan);
  for (int step = 0; step < 40; ++step) textbook.predict(context, {3.0, 0.2}, 0.025);
  return textbook;
}

Eigen::VectorXd mean_of(const JointGaussian& gaussian) {
  Eigen::VectorXd mean(3 + 2 * static_cast<Eigen::Index>(gaussian.landmarks()));
  const Pose& pose = gaussian.pose().mean;
  mean.head<3>() << pose.x, pose.y, pose.heading;
  for (std::size_t k = 0; k < gaussian.landmarks(); ++k) {
    mean.segment<2>(3 + 2 * static_cast<Eigen::Index>(k)) = gaussian.point(k).mean;
  }
  return mean;
}

TEST(JointGaussian, MovedOnceForManyStepsIsTheTextbookFilterMovedAtEach) {
  const auto textbook = textbook_driven();
  const JointGaussian gaussian = driven(Retraction::additive);
  EXPECT_LT((mean_of(gaussian) - textbook.mean()).norm(), 1e-12);
  EXPECT_LT((gaussian.pose().covariance - textbook.covariance().topLeftCorner<3, 3>()).norm(),
            1e-12);
}

TEST(JointGaussian, AFixIsFaultyAndChangesNothingIfItsCovarianceIsNotPositive) {
  JointGaussian gaussian(kRough, Retraction::additive, 3);
  gaussian.start({1.0, 2.0, 0.5}, -Eigen::Matrix3d::Identity());
  double log_density = 0.0;
  EXPECT_EQ(gaussian.update_with_fix({5.0, 5.0}, 0.1, log_density),
            JointGaussian::ObservationStatus::faulty);
  EXPECT_EQ(log_density, 0.0);
  EXPECT_EQ(gaussian.pose().mean.x, 1.0);
  EXPECT_EQ(gaussian.pose().covariance, -Eigen::Matrix3d::Identity());
}

TEST(JointFilter, CountsAFaultOfAFix) {
  const auto filter = make_ekf_slam(
      setup_for(ekf_slam_kind(), SmallWorldSettings{.noise = {.sigma_fix = 0.1}}, {}));
  const StepContext context(1, 0, 0, Parallel::serial());
  filter->start_from(context, {.pose = {{}, -Eigen::Matrix3d::Identity()}});
  filter->take_fix({5.0, 5.0});
  filter->update(context, {});
  EXPECT_EQ(filter->report().numerical_faults, 1U);
}

TEST(JointGaussian, AnIteratedDetectionEndsAtTheTopOfThePosterior) {
  const auto textbook = textbook_driven();
  JointGaussian gaussian = driven(Retraction::additive);
  const Eigen::Vector2d detected{7.0, -1.6};
  ExpectedObservation expected;
  ASSERT_EQ(gaussian.predict_observation(1, expected), JointGaussian::ObservationStatus::usable);
  gaussian.update_with(1, detected, 60, expected);
  const Eigen::VectorXd x = mean_of(gaussian);
  const auto at = linearised_observation(Pose{x(0), x(1), x(2)}, Point{x(5), x(6)});
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(2, x.size());
  H.leftCols<3>() = pose_jacobian(at);
  H.middleCols<2>(5) = landmark_jacobian(at);
  const Eigen::Vector2d R(kRough.sigma_range * kRough.sigma_range,
                          kRough.sigma_bearing * kRough.sigma_bearing);
  const Eigen::Vector2d miss =
      to_vector(residual(RangeBearing<double>{detected(0), detected(1)}, at.observation));
  // The gradient of the log posterior, times the prior's covariance, which is singular.
  const Eigen::VectorXd slope =
      textbook.covariance() * H.transpose() * R.cwiseInverse().asDiagonal() * miss -
      (x - textbook.mean());
  EXPECT_LT(slope.norm(), 2e-4);
  EXPECT_GT((x - textbook.mean()).norm(), 0.5) << "hardly moved: no test";
  JointGaussian once = driven(Retraction::additive);
  ASSERT_EQ(once.predict_observation(1, expected), JointGaussian::ObservationStatus::usable);
  once.update_with(1, detected, 0, expected);
  EXPECT_GT((mean_of(once) - x).norm(), 0.05) << "linear enough for one step: no test";
}

TEST(JointGaussian, AnIteratedDetectionPassesTheBackwardDirection) {
  // On its way the estimate passes the landmark, so that the bearing turns by more than half a turn
  // in all: only the rest of the bearing may be wrapped.
  const Belief belief{.vehicle = {},
                      .control = {.sigma = {1.0, 0.2}},
                      .sigma_range = 0.1,
                      .sigma_bearing = 2.0 * kPi / 180.0};
  JointGaussian gaussian(belief, Retraction::additive, 1);
  gaussian.start({});
  gaussian.append(Eigen::Vector2d{3.0, 0.0});
  gaussian.move(MotionIncrement(Pose{}, {.xx = 4.0, .yy = 4.0, .hh = 0.01}));
  ExpectedObservation expected;
  ASSERT_EQ(gaussian.predict_observation(0, expected), JointGaussian::ObservationStatus::usable);
  gaussian.update_with(0, Eigen::Vector2d{0.559, 1.107}, 20, expected);
  EXPECT_NEAR(gaussian.pose().mean.x, 2.75, 0.2);
  EXPECT_NEAR(gaussian.pose().mean.y, -0.5, 0.2);
}

/// A pose that knows neither its place nor its heading well, and a landmark seen from there.
JointGaussian uncertain(double heading_deviation) {
  JointGaussian gaussian({}, Retraction::additive, 1);
  gaussian.start({1.0, 2.0, 0.5});
  gaussian.move(
      MotionIncrement(Pose{}, {.xx = 0.3, .yy = 0.2, .hh = heading_deviation * heading_deviation}));
  gaussian.append(Eigen::Vector2d(5.0, 0.4));
  gaussian.move(MotionIncrement(Pose{2.0, 0.5, 0.3}, {.xx = 0.1, .yy = 0.2, .hh = 0.01}));
  return gaussian;
}

TEST(Regression, OfAMotionHasTheMomentsOfATurnedWay) {
  const double sigma = 0.3, kept = std::exp(-0.5 * sigma * sigma);
  JointGaussian gaussian({}, Retraction::additive, 1);
  gaussian.start({});
  gaussian.move(MotionIncrement(Pose{}, {.hh = sigma * sigma}));
  const MotionIncrement way(Pose{4.0, 0.0, 0.0}, {});
  const PoseMoments moved = gaussian.pose_after(gaussian.regressed(way));
  // The way is (4 cos a, 4 sin a), a ~ N(0, sigma^2); the sigma points err by sigma^6 of relative
  // size.
  EXPECT_NEAR(moved.mean.x, 4.0 * kept, 1e-4);
  EXPECT_NEAR(moved.covariance(1, 2), 4.0 * kept * sigma * sigma, 2e-3);
  EXPECT_NEAR(moved.covariance(1, 1), 8.0 * (1.0 - std::pow(kept, 4)), 0.02);
  EXPECT_NEAR(moved.covariance(0, 0), 8.0 * std::pow(1.0 - kept * kept, 2), 0.02);
  EXPECT_GT(moved.covariance(0, 0), 0.04);  // linearised it is 0
}

TEST(Regression, OfAnObservationIsTheDerivativeWhereNoiseIsSmall) {
  Belief belief{.vehicle = {}, .control = {}, .sigma_range = 1e-5, .sigma_bearing = 1e-6};
  JointGaussian gaussian(belief, Retraction::additive, 1);
  gaussian.start({1.0, 2.0, 0.5});
  gaussian.append(Eigen::Vector2d(5.0, 0.4));
  gaussian.move(MotionIncrement(Pose{2.0, 0.5, 0.3}, {.xx = 1e-10, .yy = 1e-10, .hh = 1e-10}));
  ExpectedObservation derived, regressed;
  ASSERT_EQ(gaussian.predict_observation(0, derived), JointGaussian::ObservationStatus::usable);
  ASSERT_EQ(gaussian.predict_by_sigma_points(gaussian.point(0), regressed),
            JointGaussian::ObservationStatus::usable);
  EXPECT_LT((regressed.pose_jacobian - derived.pose_jacobian).norm(), 1e-6);
  EXPECT_LT((regressed.landmark_jacobian - derived.landmark_jacobian).norm(), 1e-6);
  EXPECT_LT((regressed.observation - derived.observation).norm(), 1e-8);
}

TEST(Regression, ExpectsALongerRangeAndMoreNoiseThanTheDerivative) {
  const JointGaussian gaussian = uncertain(0.2);
  ExpectedObservation derived, regressed;
  ASSERT_EQ(gaussian.predict_observation(0, derived), JointGaussian::ObservationStatus::usable);
  ASSERT_EQ(gaussian.predict_by_sigma_points(gaussian.point(0), regressed),
            JointGaussian::ObservationStatus::usable);
  const PointMoments at = gaussian.point(0);
  const Pose& pose = gaussian.pose().mean;
  const Eigen::Vector2d away = at.mean - Eigen::Vector2d(pose.x, pose.y);
  const Eigen::Matrix2d mixed = at.cross.leftCols<2>();
  const Eigen::Matrix2d relative =
      at.covariance + gaussian.pose().covariance.topLeftCorner<2, 2>() - mixed - mixed.transpose();
  const Eigen::Vector2d across = quarter_turn() * away.normalized();
  const double variance = across.dot(relative * across);
  // Second order: the range is longer by variance / 2 r, the rest is of fourth order.
  const double longer = 0.5 * variance / away.norm();
  EXPECT_NEAR(regressed.observation(0) - derived.observation(0), longer, 0.2 * longer);
  EXPECT_GT(regressed.factor.covariance()(0, 0), derived.factor.covariance()(0, 0));
}

}  // namespace
}  // namespace montecarta::filters
