// SPDX-License-Identifier: BSD-3-Clause
// Law: the joint estimate has the pose and the landmarks of the filter as its parts. Full smoothing
// with pushed moments is an exception: its joint is of a solution of its own.
#include "filters/joint/joint_filter.hpp"
#include "filters/relative/relative_ekf_slam.hpp"
#include "filters/smoothing/smoother.hpp"
#include "tests/filters/small_world.hpp"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::filters {
namespace {

const std::size_t kLandmarks = SmallWorldSettings().landmarks;

/// Checks after every scan; returns how many landmarks there were in all.
int expect_parts(SlamFilter& filter, const SmallWorld& world) {
  int seen = 0;
  drive_through(filter, world, {}, [&](std::size_t scan) {
    const auto joint = filter.joint(kLandmarks);
    ASSERT_TRUE(joint);
    ASSERT_EQ(joint->mean.size(), 43);
    const Eigen::Matrix3d of_pose = joint->covariance.topLeftCorner<3, 3>();
    EXPECT_TRUE(of_pose.isApprox(of_pose.transpose(), 1e-12));
    std::vector<std::optional<LandmarkEstimate>> map(kLandmarks);
    filter.map(map);
    std::vector<Eigen::Index> rows = {0, 1, 2};
    for (std::size_t l = 0; l < kLandmarks; ++l) {
      const auto row = static_cast<Eigen::Index>(3 + 2 * l);
      ASSERT_EQ(map[l].has_value(), !std::isnan(joint->mean(row))) << "scan " << scan;
      if (!map[l]) continue;
      rows.insert(rows.end(), {row, row + 1});
      ++seen;
      EXPECT_TRUE(joint->mean.segment<2>(row).isApprox(map[l]->mean, 1e-11)) << "scan " << scan;
      const auto block = joint->covariance.block<2, 2>(row, row);
      EXPECT_TRUE(block.isApprox(map[l]->covariance, 1e-9)) << "scan " << scan;
    }
    const Eigen::MatrixXd P = joint->covariance(rows, rows);
    EXPECT_TRUE(P.isApprox(P.transpose(), 1e-10));
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(P).eigenvalues().minCoeff(), 0.0);
    const PoseEstimate estimate = filter.estimate();
    const PoseMoments& pose = estimate.mixture ? *estimate.mixture : estimate.spread;
    EXPECT_NEAR(joint->mean(0), pose.mean.x, 0.2) << "scan " << scan;
  });
  return seen;
}

TEST(JointEstimate, OfOneGaussianHasItsParts) {
  const SmallWorld world = small_world({.seed = 31, .scans = 60});
  for (const FilterKind& kind :
       {ekf_slam_kind(), riekf_slam_kind(), robocentric_ekf_slam_kind(), smoother_kind(),
        fixed_lag_smoother_kind(), relative_ekf_slam_kind()}) {
    for (const auto association : {Association::known, Association::nearest}) {
      for (const char* moments : {"map", "pushed"}) {
        const bool is_one = kind.name == "ekf_slam" || kind.name == "riekf_slam";
        if (!is_one && moments == std::string("pushed")) continue;
        const auto filter = make_filter(kind, {}, {{"moments", moments}}, association);
        EXPECT_GT(expect_parts(*filter, world), 100);
        const Eigen::Matrix3d P = filter->estimate().spread.covariance;
        const Eigen::MatrixXd joint = filter->joint(kLandmarks)->covariance;
        EXPECT_TRUE((joint.topLeftCorner<3, 3>().isApprox(P, 1e-9))) << kind.name << moments;
      }
    }
  }
}

// The joint is solved anew and in other coordinates than the map: near it, not equal to it.
TEST(JointEstimate, OfFullSmoothingIsNearItsMap) {
  const SmallWorld world = small_world({.seed = 33, .scans = 60});
  for (const auto association : {Association::known, Association::nearest}) {
    const auto smoother = make_filter(smoother_kind(), {}, {}, association);
    int seen = 0;
    drive_through(*smoother, world, {}, [&](std::size_t scan) {
      const auto joint = smoother->joint(kLandmarks);
      ASSERT_TRUE(joint);
      std::vector<std::optional<LandmarkEstimate>> map(kLandmarks);
      smoother->map(map);
      for (std::size_t l = 0; l < kLandmarks; ++l) {
        const auto row = static_cast<Eigen::Index>(3 + 2 * l);
        ASSERT_EQ(map[l].has_value(), !std::isnan(joint->mean(row))) << "scan " << scan;
        if (!map[l]) continue;
        ++seen;
        const Eigen::Vector2d sigma = map[l]->covariance.diagonal().cwiseSqrt();
        const Eigen::Vector2d shift = joint->mean.segment<2>(row) - map[l]->mean;
        EXPECT_LT(shift.cwiseQuotient(sigma).norm(), 0.5) << "scan " << scan;
        const Eigen::Vector2d solved = joint->covariance.diagonal().segment<2>(row).cwiseSqrt();
        EXPECT_TRUE(solved.isApprox(sigma, 0.1)) << "scan " << scan;
      }
    });
    EXPECT_GT(seen, 100);
  }
}

}  // namespace
}  // namespace montecarta::filters
