// SPDX-License-Identifier: BSD-3-Clause
#include "filters/smoothing/smoother.hpp"

#include "filters/joint/joint_filter.hpp"
#include "filters/smoothing/gauss_newton.hpp"
#include "tests/filters/reference/dense_smoother.hpp"
#include "tests/filters/same_runs.hpp"
#include "tests/filters/small_world.hpp"
#include "tests/filters/smoothing/small_graph.hpp"
#include "tests/filters/some_models.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace montecarta::filters {
namespace {

/// Largest distance [m, rad] between two estimates of the same graph.
double largest_distance(const GraphEstimate& a, const GraphEstimate& b) {
  double largest = 0.0;
  for (std::size_t t = 0; t < a.poses.size(); ++t) {
    largest = std::max(largest, boxminus(a.poses[t], b.poses[t]).norm());
  }
  for (std::size_t l = 0; l < a.landmarks.size(); ++l) {
    const Point away = a.landmarks[l] - b.landmarks[l];
    largest = std::max(largest, std::hypot(away.x, away.y));
  }
  return largest;
}

class FullSmoothingBy : public testing::TestWithParam<SomeSensor> {};

TEST_P(FullSmoothingBy, EqualsTheDenseSmoother) {
  SmallWorldSettings settings{.seed = 41, .landmarks = 21, .scans = 60};
  settings.noise.sensor = GetParam().sensor;
  const SmallWorld world = small_world(settings);
  SmallGraph small = small_graph(world, settings.noise, Beginning::dead_reckoning);
  reference::DenseSmoother dense(small.graph, settings.noise);
  dense.solve(small.estimate, 15);
  GaussNewton solver{BelievedSensor(settings.noise)};
  ASSERT_TRUE(solver.solve(small.graph, 0.0, small.estimate));
  for (std::size_t t = 0; t < small.graph.poses(); ++t) {
    EXPECT_LT(boxminus(small.estimate.poses[t], dense.pose(t)).norm(), 1e-9) << "pose " << t;
  }
  for (std::size_t l = 0; l < small.graph.landmarks(); ++l) {
    EXPECT_LT((to_vector(small.estimate.landmarks[l]) - dense.landmark(l)).norm(), 1e-9);
  }
  Eigen::Matrix3d pose;
  MapMoments map;
  solver.elimination().covariance(pose, map);
  const Eigen::MatrixXd P = dense.covariance({small.graph.poses() - 1});
  const Eigen::Index n = P.rows() - 3;
  EXPECT_LT((pose - P.topLeftCorner<3, 3>()).norm(), 1e-9);
  EXPECT_LT((map.cross.topRows(n) - P.bottomLeftCorner(n, 3)).norm(), 1e-9);
  EXPECT_LT((map.covariance.topLeftCorner(n, n) - P.bottomRightCorner(n, n)).norm(), 1e-9);
}

std::vector<SomeSensor> sensors_that_fix_landmarks() {
  std::vector<SomeSensor> sensors = some_sensors();
  std::erase_if(sensors, [](const SomeSensor& some) { return !fixes_landmark(some.sensor); });
  return sensors;
}

INSTANTIATE_TEST_SUITE_P(All, FullSmoothingBy, testing::ValuesIn(sensors_that_fix_landmarks()),
                         [](const auto& instance) { return instance.param.name; });

// The vehicle drives once around its circle of 27 m, in noise with which dead reckoning ends metres
// away: additive steps do not come from there to the minimum.
TEST(FullSmoothing, FindsTheMinimumBehindALoopFromDeadReckoningAsFromTheTruth) {
  SmallWorldSettings settings{.seed = 42, .scans = 320};
  settings.noise = {.control = {.sigma = {1.0, 10.0 * kPi / 180.0}},
                    .sigma_range = 1.2,
                    .sigma_bearing = 12.0 * kPi / 180.0};
  const SmallWorld world = small_world(settings);
  SmallGraph reckoned = small_graph(world, settings.noise, Beginning::dead_reckoning);
  SmallGraph true_path = small_graph(world, settings.noise, Beginning::truth);
  EXPECT_GT(largest_distance(reckoned.estimate, true_path.estimate), 3.0);
  GaussNewton solver(SensorNoise::of(settings.noise));
  ASSERT_TRUE(solver.solve(reckoned.graph, 1e-10, reckoned.estimate));
  ASSERT_TRUE(solver.solve(true_path.graph, 1e-10, true_path.estimate));
  EXPECT_LT(largest_distance(reckoned.estimate, true_path.estimate), 1e-3);
}

// One control step a scan has a covariance of rank two: the third direction has no noise.
TEST(FullSmoothing, TakesMotionsThatAreCertainInADirection) {
  const SmallWorldSettings settings{.seed = 43, .scans = 40, .steps_per_scan = 1};
  SmallGraph small = small_graph(small_world(settings), settings.noise, Beginning::truth);
  FactorGraph certain;  // its first control steps once more, linearised
  GraphEstimate estimate;
  certain.start({});
  Pose at;
  for (std::size_t t = 0; t < small.graph.poses(); ++t) {
    MotionIncrement motion;
    motion.advance({3.0, 0.15}, 0.025, settings.noise);
    at = composed(at, motion.pose());
    certain.add_pose(motion);
    estimate.add_pose(certain, at);
    for (const auto& [landmark, observed] : small.graph.observations_of(t)) {
      const bool fresh = landmark == certain.landmarks();
      certain.add_observation(landmark, observed);
      if (fresh)
        estimate.add_landmark(
            linearised_place(at, RangeBearing<double>{observed(0), observed(1)}).point);
    }
  }
  GaussNewton solver(SensorNoise::of(settings.noise));
  ASSERT_TRUE(solver.solve(certain, 1e-10, estimate));
  for (std::size_t t = 0; t < certain.poses(); ++t) {
    const Eigen::Matrix3d P = symmetric(certain.motion(t).covariance());
    const Eigen::Vector3d noise = boxminus(estimate.displacements[t], certain.motion(t).pose());
    const Eigen::Vector3d axis =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(P).eigenvectors().col(0);  // of no variance
    EXPECT_LT(std::abs(axis.dot(noise)), 1e-9) << "pose " << t;
  }
}

TEST(Smoother, IsTheIteratedInvariantFilterWhereItNeverLinearisesAgain) {
  const SmallWorldSettings settings{.seed = 44, .scans = 120};
  const SmallWorld world = small_world(settings);
  const auto smoother =
      make_filter(smoother_kind(), settings, {{"relinearise", "1e9"}, {"moments", "map"}});
  const auto filter =
      make_filter(riekf_slam_kind(), settings, {{"iterations", "5"}, {"motion", "quadrature"}});
  expect_same_run(*smoother, *filter, world, 1e-12);
}

TEST(Smoother, LinearisingAtEveryScanIsTheBatchEstimate) {
  const SmallWorldSettings settings{.seed = 45, .scans = 80};
  const SmallWorld world = small_world(settings);
  const auto smoother =
      make_filter(smoother_kind(), settings, {{"relinearise", "0"}, {"moments", "map"}});
  drive_through(*smoother, world);
  SmallGraph batch = small_graph(world, settings.noise, Beginning::truth);
  GaussNewton solver(SensorNoise::of(settings.noise));
  ASSERT_TRUE(solver.solve(batch.graph, 1e-12, batch.estimate));
  // Settled is a tenth of a standard deviation before the last step, which leaves far less.
  const PoseMoments now = smoother->estimate().spread;
  EXPECT_LT(boxminus(now.mean, batch.estimate.poses.back()).norm(), 1e-4);
  std::vector<std::optional<LandmarkEstimate>> map(settings.landmarks);
  smoother->map(map);
  for (std::size_t l = 0; l < batch.identities.size(); ++l) {
    const auto& landmark = map[static_cast<std::size_t>(batch.identities[l])];
    ASSERT_TRUE(landmark);
    EXPECT_LT((landmark->mean - to_vector(batch.estimate.landmarks[l])).norm(), 1e-4);
  }
}

// The joint is of a solution of its own, which no earlier linearisation affects.
TEST(Smoother, JointDoesNotDependOnWhenAllWasLinearisedAgain) {
  const SmallWorldSettings settings{.seed = 47, .scans = 120};
  const SmallWorld world = small_world(settings);
  const auto always = make_filter(smoother_kind(), settings, {{"relinearise", "0"}});
  const auto never = make_filter(smoother_kind(), settings, {{"relinearise", "1e9"}});
  drive_through(*always, world);
  drive_through(*never, world);
  const JointEstimate a = *always->joint(settings.landmarks);
  const JointEstimate b = *never->joint(settings.landmarks);
  EXPECT_EQ(b.covariance.topLeftCorner(3, 3), b.covariance.topLeftCorner(3, 3).transpose());
  const PoseMoments carried = never->estimate().spread;
  EXPECT_GT((b.mean.head<2>() - place_of(carried.mean)).norm(), 1e-4) << "was not solved anew";
  for (Eigen::Index i = 0; i < a.mean.size(); ++i) {
    const double sigma = std::sqrt(a.covariance(i, i));
    EXPECT_EQ(std::isnan(a.mean(i)), std::isnan(b.mean(i)));
    if (std::isnan(a.mean(i))) continue;
    EXPECT_LT(std::abs(a.mean(i) - b.mean(i)), 0.02 * sigma);
  }
}

// The information about a range measured without noise is infinite.
TEST(Smoother, JointOfTheCarriedBeliefInsteadOfASolutionIsANumericalFault) {
  SmallWorldSettings settings{.seed = 48, .scans = 3};
  const SmallWorld world = small_world(settings);
  settings.noise.sigma_range = 1e-200;
  const auto pushed = make_filter(smoother_kind(), settings);
  const auto carried = make_filter(smoother_kind(), settings, {{"moments", "map"}});
  drive_through(*pushed, world);
  drive_through(*carried, world);
  const JointEstimate held = *carried->joint(settings.landmarks);
  EXPECT_EQ(held.numerical_faults, 0u);
  EXPECT_TRUE(held.mean.head(3).allFinite());
  EXPECT_EQ(pushed->joint(settings.landmarks)->numerical_faults, 1u);
}

// The noise is so fine that all models are linear. The smoother is then the Kalman filter.
TEST(Smoother, IsTheKalmanFilterOnALinearModel) {
  SmallWorldSettings settings{.seed = 46, .scans = 60};
  settings.noise = fine();
  const SmallWorld world = small_world(settings);
  const auto smoother = make_filter(smoother_kind(), settings, {{"relinearise", "0"}});
  const auto kalman = make_filter(ekf_slam_kind(), settings);
  const auto expected = estimates_of(*kalman, world);
  drive_through(*smoother, world, {}, [&](std::size_t scan) {
    const PoseMoments now = smoother->estimate().spread;
    const Eigen::LLT<Eigen::Matrix3d> L(expected[scan].covariance);
    const Eigen::Vector3d way = boxminus(now.mean, expected[scan].mean);
    EXPECT_LT(L.matrixL().solve(way).norm(), 0.02) << "scan " << scan;
    EXPECT_TRUE(now.covariance.isApprox(expected[scan].covariance, 1e-3)) << "scan " << scan;
  });
}

}  // namespace
}  // namespace montecarta::filters
