// SPDX-License-Identifier: BSD-3-Clause
// A robot whose heading is known, with a sensor that measures positions, is a linear model.
#include "filters/joint/joint_filter.hpp"
#include "tests/filters/small_world.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace montecarta::filters {
namespace {

constexpr double kStep = 0.025;  // [s] of small_world()
const Control kStraight{2.5, 1.5, 0.0};

Belief linear_belief() {
  Belief belief{.vehicle = Omnidirectional{}, .control = {.sigma = {0.5, 0.3, 0.0}}};
  belief.sigma_forward = 0.1;
  belief.sigma_left = 0.2;
  belief.sensor.kind = PositionSensor();
  return belief;
}

/// The Kalman filter over the place of the vehicle and the landmarks that it has seen.
class KalmanFilter {
 public:
  void move(const Belief& belief) {
    for (Eigen::Index i = 0; i < 2; ++i) {
      const auto component = static_cast<std::size_t>(i);
      mean(i) += kStraight[component] * kStep;
      covariance(i, i) += std::pow(belief.control.sigma[component] * kStep, 2);
    }
  }
  void see(const Detection& detection, const Belief& belief) {
    const Eigen::Vector2d seen(detection[0], detection[1]);
    const Eigen::Matrix2d R =
        Eigen::Vector2d(belief.sigma_forward, belief.sigma_left).cwiseAbs2().asDiagonal();
    const auto found = std::ranges::find(identities_, detection.identity);
    const Eigen::Index row = 2 + 2 * (found - identities_.begin()), n = mean.size();
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(2, n);
    H.leftCols<2>() = -Eigen::Matrix2d::Identity();
    if (found == identities_.end()) {
      identities_.push_back(detection.identity);
      const Eigen::MatrixXd cross = covariance.topRows<2>();
      mean.conservativeResize(n + 2);
      mean.tail<2>() = mean.head<2>() + seen;
      covariance.conservativeResize(n + 2, n + 2);
      covariance.bottomLeftCorner(2, n) = cross;
      covariance.topRightCorner(n, 2) = cross.transpose();
      covariance.bottomRightCorner<2, 2>() = cross.leftCols<2>() + R;
      return;
    }
    H.middleCols<2>(row) = Eigen::Matrix2d::Identity();
    const Eigen::Matrix2d S = H * covariance * H.transpose() + R;
    const Eigen::MatrixXd K = S.llt().solve(H * covariance).transpose();
    mean += K * (seen - H * mean);
    covariance -= (K * S * K.transpose()).eval();
  }

  Eigen::VectorXd mean = Eigen::VectorXd::Zero(2);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(2, 2);

 private:
  std::vector<std::int32_t> identities_;
};

class OnALinearModel : public testing::TestWithParam<std::pair<FilterKind, const char*>> {};

TEST_P(OnALinearModel, EkfEqualsKalman) {
  const auto& [kind, iterations] = GetParam();
  const Belief belief = linear_belief();
  const SmallWorld world = small_world({.scans = 30, .noise = belief, .controls = {kStraight}});
  const auto filter = kind.make({.belief = belief,
                                 .association = {},
                                 .options = default_options(kind, {{"iterations", iterations}}),
                                 .landmarks = 20});
  KalmanFilter kalman;
  double dof = 0.0;
  drive_through(*filter, world, {}, [&](std::size_t scan) {
    for (int step = 0; step < 8; ++step) kalman.move(belief);
    for (const Detection& detection : world.drive.scan(scan)) kalman.see(detection, belief);
    const PoseMoments now = filter->estimate().spread;
    EXPECT_NEAR(now.mean.x, kalman.mean(0), 1e-10) << "scan " << scan;
    EXPECT_NEAR(now.mean.y, kalman.mean(1), 1e-10) << "scan " << scan;
    const Eigen::Matrix2d P = now.covariance.topLeftCorner<2, 2>();
    EXPECT_LT((P - kalman.covariance.topLeftCorner<2, 2>()).norm(), 1e-11) << "scan " << scan;
    dof += filter->report().nis_dof;
  });
  EXPECT_GT(dof, 100.0);
}

INSTANTIATE_TEST_SUITE_P(
    All, OnALinearModel,
    testing::Values(std::pair{ekf_slam_kind(), "0"}, std::pair{ekf_slam_kind(), "5"},
                    std::pair{riekf_slam_kind(), "0"}, std::pair{riekf_slam_kind(), "5"},
                    std::pair{fej_ekf_slam_kind(), "0"}, std::pair{oc_ekf_slam_kind(), "0"},
                    std::pair{robocentric_ekf_slam_kind(), "0"}, std::pair{ukf_slam_kind(), "0"}),
    [](const auto& instance) { return instance.param.first.name + "_" + instance.param.second; });

}  // namespace
}  // namespace montecarta::filters
