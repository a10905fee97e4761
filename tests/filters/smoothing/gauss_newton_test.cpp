// SPDX-License-Identifier: BSD-3-Clause
#include "filters/smoothing/gauss_newton.hpp"

#include "tests/filters/reference/dense_smoother.hpp"
#include "tests/filters/smoothing/small_graph.hpp"

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

TEST(FullSmoothing, EqualsTheDenseSmoother) {
  const SmallWorldSettings settings{.seed = 41, .landmarks = 21, .scans = 60};
  const SmallWorld world = small_world(settings);
  SmallGraph small = small_graph(world, settings.noise, Beginning::dead_reckoning);
  const SensorNoise noise = SensorNoise::of(settings.noise);
  reference::DenseSmoother dense(small.graph, noise);
  dense.solve(small.estimate, 15);
  GaussNewton solver(noise);
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

// One control step a scan: its covariance has rank two, and what no noise can do never happens.
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
      if (fresh) estimate.add_landmark(linearised_place(at, observed).point);
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

}  // namespace
}  // namespace montecarta::filters
