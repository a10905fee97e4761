// SPDX-License-Identifier: BSD-3-Clause
// A robot whose heading is known, with a sensor that measures positions, is a linear model.
#include "filters/joint/joint_filter.hpp"
#include "filters/smoothing/smoother.hpp"
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
  KalmanFilter() = default;
  /// Starts from a known map.
  explicit KalmanFilter(const Prior& prior) {
    const auto n = static_cast<Eigen::Index>(2 + 2 * prior.map.size());
    mean.resize(n);
    covariance.setZero(n, n);
    mean.head<2>() = place_of(prior.pose.mean);
    covariance.topLeftCorner<2, 2>() = prior.pose.covariance.topLeftCorner<2, 2>();
    for (const auto& [place, P] : prior.map) {
      const auto row = static_cast<Eigen::Index>(2 + 2 * identities_.size());
      mean.segment<2>(row) = place;
      covariance.block<2, 2>(row, row) = P;
      identities_.push_back(static_cast<std::int32_t>(identities_.size()));
    }
  }

  void move(const Belief& belief) {
    for (Eigen::Index i = 0; i < 2; ++i) {
      const auto component = static_cast<std::size_t>(i);
      mean(i) += kStraight[component] * kStep;
      covariance(i, i) += std::pow(belief.control.sigma[component] * kStep, 2) +
                          std::pow(belief.control.increment.sigma[component], 2) * kStep;
    }
  }
  void fix(const PositionFix& fix, double sigma) {
    const Eigen::Matrix2d S =
        covariance.topLeftCorner<2, 2>() + sigma * sigma * Eigen::Matrix2d::Identity();
    const Eigen::MatrixXd K = S.llt().solve(covariance.topRows<2>()).transpose();
    mean += K * (fix - mean.head<2>());
    covariance -= (K * S * K.transpose()).eval();
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

using IteratedKind = std::pair<FilterKind, const char*>;

class OnALinearModel : public testing::TestWithParam<IteratedKind> {};
class OnALinearModelWithFixes : public OnALinearModel {};

/// Drives both through the world and compares their poses after every scan.
void expect_kalman(SlamFilter& filter, KalmanFilter kalman, const SmallWorld& world,
                   const Belief& belief) {
  double dof = 0.0;
  drive_through(filter, world, {}, [&](std::size_t scan) {
    for (int step = 0; step < 8; ++step) kalman.move(belief);
    if (const auto fix = world.drive.fix(scan)) kalman.fix(*fix, *belief.sigma_fix);
    for (const Detection& detection : world.drive.scan(scan)) kalman.see(detection, belief);
    const PoseMoments now = filter.estimate().spread;
    EXPECT_NEAR(now.mean.x, kalman.mean(0), 1e-10) << "scan " << scan;
    EXPECT_NEAR(now.mean.y, kalman.mean(1), 1e-10) << "scan " << scan;
    const Eigen::Matrix2d P = now.covariance.topLeftCorner<2, 2>();
    EXPECT_LT((P - kalman.covariance.topLeftCorner<2, 2>()).norm(), 1e-11) << "scan " << scan;
    dof += filter.report().nis_dof;
  });
  EXPECT_GT(dof, 100.0);
}

TEST_P(OnALinearModel, EkfEqualsKalman) {
  const auto& [kind, iterations] = GetParam();
  const SmallWorldSettings settings{.scans = 30, .noise = linear_belief(), .controls = {kStraight}};
  const auto filter = make_filter(kind, settings, {{"iterations", iterations}});
  expect_kalman(*filter, KalmanFilter(), small_world(settings), settings.noise);
}

/// How many poses a smoother keeps makes no difference where nothing is to be linearised again.
class FixedLagOnALinearModel : public testing::TestWithParam<std::pair<const char*, const char*>> {
};

TEST_P(FixedLagOnALinearModel, EqualsKalman) {
  const auto& [lag, jacobians] = GetParam();
  const SmallWorldSettings settings{.scans = 30, .noise = linear_belief(), .controls = {kStraight}};
  const auto filter =
      make_filter(fixed_lag_smoother_kind(), settings, {{"lag", lag}, {"jacobians", jacobians}});
  expect_kalman(*filter, KalmanFilter(), small_world(settings), settings.noise);
}

INSTANTIATE_TEST_SUITE_P(All, FixedLagOnALinearModel,
                         testing::Values(std::pair("1", "latest"), std::pair("4", "latest"),
                                         std::pair("100", "latest"), std::pair("1", "first"),
                                         std::pair("4", "first")),
                         [](const auto& instance) {
                           return std::string(instance.param.second) + instance.param.first;
                         });

/// The same for filters that can be given a map.
class InALinearKnownMap : public testing::TestWithParam<IteratedKind> {};

TEST_P(InALinearKnownMap, LocalisationEqualsKalman) {
  const auto& [kind, iterations] = GetParam();
  const SmallWorldSettings settings{.scans = 30, .noise = linear_belief(), .controls = {kStraight}};
  for (const double landmark : {0.0, 0.3}) {
    SCOPED_TRACE(landmark);
    const SmallWorld world =
        in_known_map(small_world(settings), {.position = 0.7, .landmark = landmark});
    const auto filter =
        kind.make(in_known_map(setup_for(kind, settings, {{"iterations", iterations}})));
    expect_kalman(*filter, KalmanFilter(*world.drive.prior), world, settings.noise);
  }
}

TEST_P(OnALinearModel, NoiseOfTheStepEqualsKalman) {
  const auto& [kind, iterations] = GetParam();
  Belief belief = linear_belief();
  belief.control.increment = {.model = IncrementModel::additive, .sigma = {0.1, 0.2, 0.0}};
  const SmallWorldSettings settings{.scans = 30, .noise = belief, .controls = {kStraight}};
  const auto filter = make_filter(kind, settings, {{"iterations", iterations}});
  expect_kalman(*filter, KalmanFilter(), small_world(settings), belief);
}

TEST_P(OnALinearModelWithFixes, FixesEqualKalman) {
  const auto& [kind, iterations] = GetParam();
  Belief belief = linear_belief();
  belief.sigma_fix = 0.3;
  const SmallWorldSettings settings{.scans = 30, .noise = belief, .controls = {kStraight}};
  const SmallWorld world = with_fixes(small_world(settings), belief, 2);
  const auto filter = make_filter(kind, settings, {{"iterations", iterations}});
  expect_kalman(*filter, KalmanFilter(), world, belief);
  const SmallWorld known = in_known_map(world, {.position = 0.7, .landmark = 0.3});
  const auto informed =
      kind.make(in_known_map(setup_for(kind, settings, {{"iterations", iterations}})));
  expect_kalman(*informed, KalmanFilter(*known.drive.prior), known, belief);
}

std::vector<IteratedKind> iterated_kinds() {
  return {{ekf_slam_kind(), "0"},
          {ekf_slam_kind(), "5"},
          {riekf_slam_kind(), "0"},
          {riekf_slam_kind(), "5"},
          {fej_ekf_slam_kind(), "0"},
          {oc_ekf_slam_kind(), "0"},
          {robocentric_ekf_slam_kind(), "0"},
          {ukf_slam_kind(), "0"},
          {right_ukf_slam_kind(), "0"},
          {left_ukf_slam_kind(), "0"}};
}

std::vector<IteratedKind> kinds_that_localise() {
  std::vector<IteratedKind> kinds = iterated_kinds();
  std::erase_if(kinds, [](const IteratedKind& kind) { return !kind.first.takes_prior; });
  return kinds;
}

std::vector<IteratedKind> kinds_with_fixes() {
  std::vector<IteratedKind> kinds = iterated_kinds();
  std::erase_if(kinds, [](const IteratedKind& kind) { return !kind.first.takes_fixes; });
  return kinds;
}

struct IteratedName {
  std::string operator()(const testing::TestParamInfo<IteratedKind>& instance) const {
    return instance.param.first.name + "_" + instance.param.second;
  }
};

INSTANTIATE_TEST_SUITE_P(All, OnALinearModel, testing::ValuesIn(iterated_kinds()), IteratedName());
INSTANTIATE_TEST_SUITE_P(All, InALinearKnownMap, testing::ValuesIn(kinds_that_localise()),
                         IteratedName());
INSTANTIATE_TEST_SUITE_P(All, OnALinearModelWithFixes, testing::ValuesIn(kinds_with_fixes()),
                         IteratedName());

}  // namespace
}  // namespace montecarta::filters
