// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/nees_bounds.hpp"
#include "filters/joint/joint_filters.hpp"
#include "filters/joint/retraction.hpp"
#include "tests/filters/default_options.hpp"
#include "tests/filters/reference/invariant_ekf_slam.hpp"
#include "tests/filters/small_world.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace montecarta::filters {
namespace {

using Make = std::unique_ptr<SlamFilter> (*)(const FilterSetup&);

FilterSetup setup_for(std::size_t landmarks, const Belief& belief = {}) {
  return {.belief = belief,
          .association = {},
          .options = default_options(ekf_slam_kind()),
          .landmarks = landmarks};
}

/// The literal filter behind the signature of a SlamFilter.
struct LiteralRunner {
  reference::InvariantEkfSlam filter{Belief{}};
  void start(const Pose& pose) { filter.start(pose); }
  void predict(const StepContext&, const Control& control, double duration) {
    filter.predict(control, duration);
  }
  void update(const StepContext&, Scan scan) { filter.update(scan); }
};

TEST(Retraction, TheExponentialIsTheSumOfManySmallTurns) {
  for (const double turn : {-2.0, -1e-5, 0.0, 3e-4, 0.7}) {
    Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
    constexpr int kParts = 2000;
    for (int k = 0; k < kParts; ++k) {
      sum += Eigen::Rotation2Dd(turn * (k + 0.5) / kParts).toRotationMatrix() / kParts;
    }
    EXPECT_LT((exponential_jacobian(turn) - sum).norm(), 1e-6) << turn;
    const Eigen::Matrix2d R = Eigen::Rotation2Dd(turn).toRotationMatrix();
    EXPECT_LT((turn * exponential_jacobian(turn) * quarter_turn() - R + Eigen::Matrix2d::Identity())
                  .norm(),
              1e-15)
        << turn;
  }
}

TEST(RiekfSlam, EqualsTheLiteralFilterOnTheGroup) {
  const SmallWorld world = small_world({.seed = 5, .landmarks = 21, .scans = 250});
  std::vector<Pose> poses;
  std::vector<Eigen::MatrixXd> covariances;
  LiteralRunner literal;
  drive_through(literal, world, {4.0, -3.0, 0.5}, [&](std::size_t) {
    poses.push_back(literal.filter.pose());
    covariances.push_back(literal.filter.covariance());
  });
  const auto filter = make_riekf_slam(setup_for(21));
  std::vector<std::optional<LandmarkEstimate>> map(21);
  drive_through(*filter, world, {4.0, -3.0, 0.5}, [&](std::size_t s) {
    const PoseMoments& pose = filter->estimate().spread;
    EXPECT_LT(boxminus(pose.mean, poses[s]).norm(), 1e-9) << "scan " << s;
    EXPECT_LT((pose.covariance - covariances[s].topLeftCorner<3, 3>()).norm(), 1e-9)
        << "scan " << s;
    filter->map(map);
  });
  for (std::int32_t k = 0; k < 21; ++k) {
    const std::size_t point = literal.filter.point_of(k);
    ASSERT_EQ(point > 0, map[static_cast<std::size_t>(k)].has_value()) << "landmark " << k;
    if (point == 0) continue;
    const LandmarkEstimate& landmark = *map[static_cast<std::size_t>(k)];
    const Eigen::Index row = reference::InvariantEkfSlam::row(point);
    EXPECT_EQ(landmark.covariance, landmark.covariance.transpose());
    EXPECT_LT((landmark.mean - literal.filter.points[point]).norm(), 1e-9);
    EXPECT_LT((landmark.covariance - covariances.back().block<2, 2>(row, row)).norm(), 1e-9);
  }
}

TEST(RiekfSlam, IsEkfSlamUntilALandmarkIsSeenAgain) {
  const SmallWorld world = small_world({.seed = 6, .scans = 3});
  const auto plain = make_ekf_slam(setup_for(20));
  const auto invariant = make_riekf_slam(setup_for(20));
  const auto advance = [&](SlamFilter& filter, std::uint32_t step) {
    filter.predict(StepContext(6, 0, step, Parallel::serial()), world.drive.controls[step], 0.025);
    return filter.estimate().spread;
  };
  const auto expect_equal = [&](std::uint32_t step) {
    const PoseMoments a = advance(*plain, step), b = advance(*invariant, step);
    EXPECT_EQ(boxminus(a.mean, b.mean).norm(), 0.0) << "step " << step;
    EXPECT_EQ(a.covariance, b.covariance) << "step " << step;
  };
  plain->start({});
  invariant->start({});
  for (std::uint32_t step = 0; step < 8; ++step) expect_equal(step);
  for (auto* filter : {plain.get(), invariant.get()}) {
    filter->update(StepContext(6, 0, 7, Parallel::serial()), world.drive.scan(0));
  }
  for (std::uint32_t step = 8; step < 16; ++step) expect_equal(step);
}

/// Noise that bends the models: here EKF-SLAM and RI-EKF-SLAM part.
Belief rough() { return {.control = {.sigma = {0.3, 0.1}}, .sigma_bearing = 0.05}; }

/// How much of the heading's variance is left to a vehicle that drove blindly, stood, and looked a
/// hundred times at landmarks it had never seen before: nothing of that tells where x points.
double heading_variance_left(Make make) {
  const auto filter = make(setup_for(3, rough()));
  filter->start({5.0, 2.0, 1.0});
  RngStream draw({.seed = 12, .purpose = Draw::test});
  const StepContext context(12, 0, 0, Parallel::serial());
  for (int step = 0; step < 200; ++step) filter->predict(context, {3.0, 0.1}, 0.025);
  const double before = filter->estimate().spread.covariance(2, 2);
  for (int look = 0; look < 100; ++look) {
    std::vector<Detection> scan{{10.0, 0.5, 0}, {15.0, -0.6, 1}, {20.0, 0.1, 2}};
    for (Detection& detection : scan) {
      detection[0] += rough().sigma_range * draw.normal();
      detection[1] += rough().sigma_bearing * draw.normal();
    }
    filter->update(context, scan);
  }
  return filter->estimate().spread.covariance(2, 2) / before;
}

TEST(RiekfSlam, AStandingVehicleLearnsNothingOfItsHeadingFromNewLandmarks) {
  EXPECT_NEAR(heading_variance_left(make_riekf_slam), 1.0, 1e-12);
  EXPECT_LT(heading_variance_left(make_ekf_slam), 0.7);  // takes the jitter of its map for news
}

double mean_nees(Make make, std::uint64_t runs, const SmallWorldSettings& settings) {
  const auto filter = make(setup_for(settings.landmarks, settings.noise));
  double sum = 0.0;
  for (std::uint64_t run = 0; run < runs; ++run) {
    SmallWorldSettings here = settings;
    here.seed = settings.seed + run;
    const SmallWorld world = small_world(here);
    drive_through(*filter, world, {}, [](std::size_t) {});
    const PoseMoments belief = filter->estimate().spread;
    const Eigen::Vector3d error = boxminus(world.drive.truth.back(), belief.mean);
    sum += error.dot(belief.covariance.llt().solve(error));
  }
  return sum / static_cast<double>(runs);
}

TEST(RiekfSlam, StaysConsistentWhereEkfSlamDoesNot) {
  constexpr std::uint64_t kRuns = 200;
  const SmallWorldSettings settings{.seed = 900, .scans = 150, .noise = rough()};
  // Five standard errors, as a level of the exact interval.
  const analysis::Interval band = analysis::nees_bounds(kRuns, 3, 1.0 - 5.7e-7);
  const double invariant = mean_nees(make_riekf_slam, kRuns, settings);
  EXPECT_GT(invariant, band.lower);
  EXPECT_LT(invariant, band.upper);
  EXPECT_GT(mean_nees(make_ekf_slam, kRuns, settings), 1.5 * band.upper);
}

}  // namespace
}  // namespace montecarta::filters
