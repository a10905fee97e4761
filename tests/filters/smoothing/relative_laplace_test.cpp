// SPDX-License-Identifier: BSD-3-Clause
#include "filters/smoothing/relative_laplace.hpp"

#include "filters/smoothing/gauss_newton.hpp"
#include "tests/filters/reference/dense_smoother.hpp"
#include "tests/filters/small_world.hpp"
#include "tests/filters/smoothing/small_graph.hpp"

#include <gtest/gtest.h>

#include <set>

namespace montecarta::filters {
namespace {

/// A small world's graph with its estimate of least squares.
struct Solved {
  explicit Solved(const SmallWorldSettings& settings)
      : small(small_graph(small_world(settings), settings.noise, Beginning::truth)),
        solver(SensorNoise::of(settings.noise)) {
    EXPECT_TRUE(solver.solve(small.graph, 0.0, small.estimate));
  }
  JointEstimate relative_laplace() const {
    return RelativeLaplace().of(small.graph, small.estimate, solver.elimination());
  }
  SmallGraph small;
  GaussNewton solver;
};

/// Largest difference of covariances, as a share of the standard deviations.
double largest_difference(const Eigen::MatrixXd& P, const Eigen::MatrixXd& expected) {
  const Eigen::VectorXd sigma = expected.diagonal().cwiseSqrt().cwiseInverse();
  return (sigma.asDiagonal() * (P - expected) * sigma.asDiagonal()).cwiseAbs().maxCoeff();
}

TEST(PosesGivenMap, CovarianceIsThatOfTheDenseSmoother) {
  const SmallWorldSettings settings{.seed = 51, .landmarks = 21, .scans = 110};
  const Solved solved(settings);
  reference::DenseSmoother dense(solved.small.graph, settings.noise);
  dense.solve(solved.small.estimate, 1);
  const std::vector<std::size_t> chosen{0, 1, 3, 4};
  std::vector<std::size_t> poses;
  for (const std::size_t i : chosen)
    poses.push_back(solved.solver.elimination().segment(i).last_pose());
  ASSERT_EQ(poses.back(), 109U);
  const Eigen::MatrixXd P = PosesGivenMap().covariance(solved.solver.elimination(), chosen);
  EXPECT_LT(largest_difference(P, dense.covariance(poses)), 1e-9);
}

/// Converts to the covariance in map coordinates.
double difference(const Solved& solved) {
  const Elimination& elimination = solved.solver.elimination();
  const std::vector<std::size_t> newest{elimination.segments() - 1};
  return largest_difference(solved.relative_laplace().covariance,
                            PosesGivenMap().covariance(elimination, newest));
}

// Noise so fine that coordinates do not matter; in the first segment the start is the only frame.
TEST(RelativeLaplace, IsLaplaceInMapCoordinatesWhereAllIsLinear) {
  for (const std::size_t scans : {20, 24, 25, 100}) {
    EXPECT_LT(difference(Solved({.seed = 52, .landmarks = 21, .scans = scans, .noise = fine()})),
              1e-3);
  }
}

TEST(RelativeLaplace, HoldsLandmarksInFewerFramesWhereThereAreTooMany) {
  const Solved solved({.seed = 53,
                       .landmarks = 900,
                       .scans = 1440,
                       .steps_per_scan = 1,
                       .max_range = 3.0,
                       .noise = fine()});
  std::set<std::size_t> segments;
  for (std::size_t l = 0; l < solved.small.graph.landmarks(); ++l)
    segments.insert(solved.small.graph.first_pose_of(l) / 24);
  ASSERT_GT(segments.size(), 40U);
  EXPECT_LT(difference(solved), 1e-3);
}

// The vehicle drives straight over the first of three landmarks, at the pose that is the frame of
// that landmark: its covariance in polar coordinates of this frame would be no number.
TEST(RelativeLaplace, KeepsALandmarkNearAFrameInCartesianCoordinates) {
  const Belief belief{
      .control = {.sigma = {0.01, 0.001}}, .sigma_range = 0.01, .sigma_bearing = 0.2 * kPi / 180.0};
  const std::vector<Point> landmarks{{24.0002, 0.0}, {10.0, 8.0}, {30.0, -6.0}};
  SmallGraph small;
  small.graph.start({});
  for (int scan = 1; scan <= 30; ++scan) {
    MotionIncrement motion;
    advance(motion, {1.0, 0.0}, 1.0, belief, Motion::quadrature);
    small.graph.add_pose(motion);
    const Pose pose{static_cast<double>(scan), 0.0, 0.0};
    small.estimate.add_pose(small.graph, pose);
    for (std::uint32_t l = 0; l < landmarks.size(); ++l) {
      const Point& place = landmarks[l];
      if (std::hypot(place.x - pose.x, place.y) < 0.5) continue;
      small.graph.add_observation(l, to_vector(linearised_observation(pose, place).observation));
      if (scan == 1) small.estimate.add_landmark(place);
    }
  }
  GaussNewton solver(SensorNoise::of(belief));
  ASSERT_TRUE(solver.solve(small.graph, 0.0, small.estimate));
  const std::vector<std::size_t> newest{1};
  const JointEstimate joint =
      RelativeLaplace().of(small.graph, small.estimate, solver.elimination());
  EXPECT_LT(largest_difference(joint.covariance,
                               PosesGivenMap().covariance(solver.elimination(), newest)),
            0.05);
  EXPECT_NEAR(joint.mean(3), landmarks[0].x, 0.01);
  EXPECT_NEAR(joint.mean(4), landmarks[0].y, 0.01);
}

// The vehicle turned half around in noise of ten degrees a step: the mean heading is the
// estimate's, the mean place lies nearer to the start than the most probable one.
TEST(RelativeLaplace, ShortensTheWayThatAnUncertainHeadingBends) {
  SmallWorldSettings settings{.seed = 55, .landmarks = 4, .scans = 60};
  settings.noise = {.control = {.sigma = {0.3, 20.0 * kPi / 180.0}},
                    .sigma_range = 0.1,
                    .sigma_bearing = 4.0 * kPi / 180.0};
  const Solved solved(settings);
  const JointEstimate joint = solved.relative_laplace();
  const Pose& estimate = solved.small.estimate.poses.back();
  EXPECT_NEAR(wrap(joint.mean(2) - estimate.heading), 0.0, 1e-9);
  EXPECT_LT(joint.mean.head<2>().norm(), std::hypot(estimate.x, estimate.y));
}

}  // namespace
}  // namespace montecarta::filters
