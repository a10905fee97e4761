// SPDX-License-Identifier: BSD-3-Clause
#include "filters/relative/relative_ekf_slam.hpp"

#include "filters/joint/joint_filter.hpp"
#include "filters/smoothing/smoother.hpp"
#include "tests/filters/small_world.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace montecarta::filters {
namespace {

void expect_close(const std::vector<PoseMoments>& these, const std::vector<PoseMoments>& those,
                  double deviations, double share) {
  ASSERT_EQ(these.size(), those.size());
  for (std::size_t scan = 0; scan < these.size(); ++scan) {
    const Eigen::LLT<Eigen::Matrix3d> L(those[scan].covariance);
    const Eigen::Vector3d way = boxminus(these[scan].mean, those[scan].mean);
    EXPECT_LT(L.matrixL().solve(way).norm(), deviations) << "scan " << scan;
    EXPECT_TRUE(these[scan].covariance.isApprox(those[scan].covariance, share)) << "scan " << scan;
  }
}

// The noise is so fine that all models are linear.
TEST(RelativeEkfSlam, IsTheKalmanFilterOnALinearModel) {
  SmallWorldSettings settings{.seed = 46, .scans = 60};
  settings.noise = fine();
  const SmallWorld world = small_world(settings);
  for (const auto association : {Association::known, Association::nearest}) {
    const auto kalman = make_filter(ekf_slam_kind(), settings, {}, association);
    const auto filter = make_filter(relative_ekf_slam_kind(), settings, {}, association);
    expect_close(estimates_of(*filter, world), estimates_of(*kalman, world), 0.02, 1e-3);
  }
}

TEST(RelativeEkfSlam, IsThatAlsoWhereEveryLandmarkIsInitialisedAgain) {
  SmallWorldSettings settings{.seed = 47, .scans = 60};
  settings.noise = fine();
  const SmallWorld world = small_world(settings);
  const auto expected = estimates_of(*make_filter(ekf_slam_kind(), settings), world);
  for (const char* lag : {"0", "3"}) {
    const auto filter = make_filter(relative_ekf_slam_kind(), settings,
                                    {{"bend", "0"}, {"lag", lag}, {"frames", "8"}});
    expect_close(estimates_of(*filter, world), expected, 0.02, 2e-3);
  }
}

// Only the reports use their detections.
TEST(RelativeEkfSlam, LandmarksBehindABentWayWait) {
  SmallWorldSettings settings{.seed = 48, .scans = 2};
  settings.noise = fine();
  const SmallWorld world = small_world(settings);
  const auto waiting = make_filter(relative_ekf_slam_kind(), settings, {{"bend", "0"}});
  const auto using_all = make_filter(relative_ekf_slam_kind(), settings, {{"bend", "1e9"}});
  expect_close(estimates_of(*waiting, world), estimates_of(*using_all, world), 0.01, 1e-3);
  EXPECT_EQ(waiting->report().nis_dof, 0U);
  EXPECT_GT(using_all->report().nis_dof, 4U);
}

/// Noise with which the heading is lost and a loop of 27 m closes far from where it began.
SmallWorldSettings rough() {
  SmallWorldSettings settings{.seed = 42, .scans = 330};
  settings.noise = {.control = {.sigma = {1.0, 10.0 * kPi / 180.0}},
                    .sigma_range = 0.5,
                    .sigma_bearing = 5.0 * kPi / 180.0};
  return settings;
}

/// The farthest [standard deviations] that its estimates are from those of full smoothing.
double farthest_from_smoothing(const char* bend, const SmallWorldSettings& settings) {
  const SmallWorld world = small_world(settings);
  const auto expected = estimates_of(*make_filter(smoother_kind(), settings), world);
  const auto now =
      estimates_of(*make_filter(relative_ekf_slam_kind(), settings, {{"bend", bend}}), world);
  double farthest = 0.0;
  for (std::size_t scan = 0; scan < now.size(); ++scan) {
    const Eigen::LLT<Eigen::Matrix3d> L(expected[scan].covariance);
    const Eigen::Vector3d way = boxminus(now[scan].mean, expected[scan].mean);
    farthest = std::max(farthest, L.matrixL().solve(way).norm());
    EXPECT_NEAR(now[scan].covariance(2, 2) / expected[scan].covariance(2, 2), 1.0, 0.2);
  }
  return farthest;
}

TEST(RelativeEkfSlam, IsNearFullSmoothingBehindALoop) {
  EXPECT_LT(farthest_from_smoothing("0.05", rough()), 0.3);
  EXPECT_LT(farthest_from_smoothing("0.3", rough()), 0.3);
}

// Between two scans the estimate is predicted from that of the scan before.
TEST(RelativeEkfSlam, EstimatesBetweenScans) {
  const SmallWorldSettings settings;
  const SmallWorld world = small_world(settings);
  const auto filter = make_filter(relative_ekf_slam_kind(), settings);
  drive_through(*filter, world);
  const StepContext context(1, 0, 999, Parallel::serial());
  const PoseMoments before = filter->estimate().spread;
  filter->predict(context, {3.0, 0.0}, 0.2);
  const PoseMoments moved = filter->estimate().spread;
  EXPECT_NEAR(std::hypot(moved.mean.x - before.mean.x, moved.mean.y - before.mean.y), 0.6, 0.02);
  EXPECT_GT(moved.covariance.determinant(), before.covariance.determinant());
  filter->update(context, {});
  const PoseMoments after = filter->estimate().spread;
  EXPECT_LT(boxminus(after.mean, moved.mean).norm(), 1e-12);
  EXPECT_LT((after.covariance - moved.covariance).norm(), 1e-12);
}

}  // namespace
}  // namespace montecarta::filters
