// SPDX-License-Identifier: BSD-3-Clause
#include "filters/smoothing/pose_window.hpp"

#include "filters/smoothing/smoother.hpp"
#include "tests/filters/same_runs.hpp"
#include "tests/filters/small_world.hpp"
#include "tests/filters/smoothing/small_graph.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace montecarta::filters {
namespace {

/// Puts pose `t` of a graph with its observations into the window, and solves it to rounding.
void take_scan(PoseWindow& window, const FactorGraph& all, std::size_t t) {
  window.add_pose(all.motion(t));
  for (const auto& [landmark, observed] : all.observations_of(t))
    window.add_observation(landmark, observed);
  for (int again = 0; again < 3; ++again) ASSERT_TRUE(window.solve(1e-24));
}

/// Covariance of the newest pose of a window and of its map.
Eigen::MatrixXd covariance_of(const PoseWindow& window) {
  Eigen::Matrix3d pose;
  MapMoments map;
  window.elimination().covariance(pose, map);
  const Eigen::Index n = window.elimination().map_rows();
  Eigen::MatrixXd P(3 + n, 3 + n);
  P << pose, map.cross.topRows(n).transpose(), map.cross.topRows(n),
      map.covariance.topLeftCorner(n, n);
  return P.selfadjointView<Eigen::Lower>();
}

SmallGraph noisy_graph(std::uint64_t seed, const Belief& noise = {}) {
  const SmallWorldSettings settings{.seed = seed, .scans = 60, .noise = noise};
  return small_graph(small_world(settings), noise, Beginning::dead_reckoning);
}

class PoseWindowWith : public testing::TestWithParam<Jacobians> {};

TEST_P(PoseWindowWith, MorePosesThanTheDriveHasIsFullSmoothing) {
  SmallGraph batch = noisy_graph(61);
  GaussNewton solver(SensorNoise::of({}));
  ASSERT_TRUE(solver.solve(batch.graph, 1e-24, batch.estimate));
  PoseWindow window(SensorNoise::of({}), batch.graph.poses(), GetParam());
  window.start(batch.graph.start());
  for (std::size_t t = 0; t < batch.graph.poses(); ++t) take_scan(window, batch.graph, t);
  for (std::size_t t = 0; t < batch.graph.poses(); ++t)
    EXPECT_LT(boxminus(window.estimate().poses[t], batch.estimate.poses[t]).norm(), 1e-9);
  Eigen::Matrix3d pose;
  MapMoments map;
  solver.elimination().covariance(pose, map);
  EXPECT_LT((covariance_of(window).topLeftCorner<3, 3>() - pose).norm(), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Both, PoseWindowWith, testing::Values(Jacobians::latest, Jacobians::first),
                         [](const auto& instance) {
                           return instance.param == Jacobians::first ? "First" : "Latest";
                         });

/// The iterated extended Kalman filter over the newest pose and the map (EQUATIONS (15.1)), which
/// takes the detections of a scan together and iterates to rounding.
class IteratedKalmanFilter {
 public:
  explicit IteratedKalmanFilter(const Belief& belief) : sensor_(belief) {}

  void take_scan(const FactorGraph& all, std::size_t t) {
    move(all.motion(t));
    const Eigen::VectorXd predicted = x;
    const auto n_known = static_cast<std::uint32_t>((x.size() - 3) / 2);
    std::vector<FactorGraph::Observation> known, fresh;
    for (const auto& seen : all.observations_of(t))
      (seen.landmark < n_known ? known : fresh).push_back(seen);
    Eigen::MatrixXd H, K;
    for (int iteration = 0; iteration < 60; ++iteration) {
      Eigen::VectorXd residual;
      linearise(known, residual, H);
      Eigen::MatrixXd S = H * P * H.transpose();
      for (Eigen::Index i = 0; i < S.rows(); ++i) S(i, i) += sensor_.variances()(i % 2);
      K = S.llt().solve(H * P).transpose();
      x = predicted + K * (residual - H * (predicted - x));
    }
    P = (P - K * H * P).eval();
    for (const auto& seen : fresh) append(seen);
  }
  Pose pose() const { return {x(0), x(1), x(2)}; }

  Eigen::VectorXd x = Eigen::VectorXd::Zero(3);
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(3, 3);

 private:
  void move(const MotionIncrement& motion) {
    const PoseGaussian<double> moved = motion.from(pose());
    Eigen::MatrixXd F = Eigen::MatrixXd::Identity(x.size(), x.size());
    F.block<2, 1>(0, 2) << -(moved.mean.y - x(1)), moved.mean.x - x(0);
    P = (F * P * F.transpose()).eval();
    P.topLeftCorner<3, 3>() += symmetric(moved.covariance);
    x.head<3>() << moved.mean.x, moved.mean.y, moved.mean.heading;
  }
  void linearise(const std::vector<FactorGraph::Observation>& known, Eigen::VectorXd& residual,
                 Eigen::MatrixXd& H) const {
    const auto rows = static_cast<Eigen::Index>(2 * known.size());
    residual.resize(rows);
    H.setZero(rows, x.size());
    for (Eigen::Index row = 0; row < rows; row += 2) {
      const auto& [landmark, observed] = known[static_cast<std::size_t>(row / 2)];
      const Eigen::Index column = 3 + row_of(landmark);
      const auto at = sensor_.linearised(pose(), Point{x(column), x(column + 1)}).value();
      residual.segment<2>(row) = sensor_.residual(observed, at.value);
      H.block<2, 3>(row, 0) = at.by_pose;
      H.block<2, 2>(row, column) = at.by_landmark;
    }
  }
  void append(const FactorGraph::Observation& seen) {
    const PlacedLandmark placed = sensor_.placed(pose(), seen.observed);
    const Eigen::Index n = x.size();
    const Eigen::MatrixXd cross = placed.by_pose * P.topRows<3>();
    const Eigen::Matrix2d own =
        placed.by_pose * P.topLeftCorner<3, 3>() * placed.by_pose.transpose() +
        placed.by_detection * sensor_.variances().asDiagonal() * placed.by_detection.transpose();
    x.conservativeResize(n + 2);
    x.tail<2>() = placed.point;
    P.conservativeResize(n + 2, n + 2);
    P.bottomLeftCorner(2, n) = cross;
    P.topRightCorner(n, 2) = cross.transpose();
    P.bottomRightCorner<2, 2>() = own;
  }

  BelievedSensor sensor_;
};

TEST(PoseWindow, OfOnePoseIsTheIteratedKalmanFilter) {
  const SmallGraph small = noisy_graph(62);
  PoseWindow window(SensorNoise::of({}), 1, Jacobians::latest);
  window.start(small.graph.start());
  IteratedKalmanFilter kalman{Belief()};
  for (std::size_t t = 0; t < small.graph.poses(); ++t) {
    take_scan(window, small.graph, t);
    kalman.take_scan(small.graph, t);
    EXPECT_LT(boxminus(window.estimate().poses.back(), kalman.pose()).norm(), 1e-9) << t;
    EXPECT_LT((covariance_of(window) - kalman.P).norm(), 1e-9) << t;
  }
}

/// Variance of the newest heading where only the first motion has noise. Detections say nothing
/// about the heading of the first pose, and the later ones turn with it.
double heading_variance(Jacobians jacobians, std::size_t most_poses) {
  const SmallGraph small = noisy_graph(63);
  PoseWindow window(SensorNoise::of({}), most_poses, jacobians);
  window.start(small.graph.start());
  FactorGraph certain;
  certain.start(small.graph.start());
  for (std::size_t t = 0; t < small.graph.poses(); ++t) {
    const MotionIncrement& motion = small.graph.motion(t);
    const Symmetric3<double> first{.xx = 0.25, .yy = 0.25, .hh = 0.01};
    certain.add_pose({motion.pose(), t == 0 ? first : Symmetric3<double>{}});
    for (const auto& [landmark, observed] : small.graph.observations_of(t))
      certain.add_observation(landmark, observed);
    take_scan(window, certain, t);
  }
  return covariance_of(window)(2, 2);
}

TEST(PoseWindow, FirstEstimatesDoNotLearnTheHeadingFromDetections) {
  for (const std::size_t most_poses : {1U, 4U, 20U}) {
    EXPECT_NEAR(heading_variance(Jacobians::first, most_poses), 0.01, 1e-9) << most_poses;
    EXPECT_LT(heading_variance(Jacobians::latest, most_poses), 0.009) << most_poses;
  }
}

// Noise so large that steps with derivatives at first estimates diverge if taken in full.
TEST(FixedLagSmoother, WithFirstEstimatesStaysInTheWorldInMuchNoise) {
  for (std::uint64_t seed = 64; seed < 72; ++seed) {
    SmallWorldSettings settings{.seed = seed, .scans = 200};
    settings.noise = {.control = {.sigma = {2.0, 10.0 * kPi / 180.0}},
                      .sigma_range = 6.0,
                      .sigma_bearing = 60.0 * kPi / 180.0};
    const SmallWorld world = small_world(settings);
    const auto filter = make_filter(fixed_lag_smoother_kind(), settings, {{"jacobians", "first"}});
    drive_through(*filter, world, {}, [&](std::size_t scan) {
      const Pose& truth = world.drive.truth[world.itinerary.scan_step[scan]];
      const Pose now = filter->estimate().spread.mean;
      EXPECT_LT(boxminus(now, truth).head<2>().norm(), 50.0) << seed;
    });
  }
}

}  // namespace
}  // namespace montecarta::filters
