// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/joint_filters.hpp"
#include "tests/filters/default_options.hpp"
#include "tests/filters/reference/robocentric_ekf_slam.hpp"
#include "tests/filters/small_world.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <vector>

namespace montecarta::filters {
namespace {

std::unique_ptr<SlamFilter> robocentric(const Belief& belief, std::size_t landmarks) {
  const FilterKind kind = robocentric_ekf_slam_kind();
  return kind.make({.belief = belief,
                    .association = {},
                    .options = default_options(kind),
                    .landmarks = landmarks});
}

/// The literal filter behind the signature of a SlamFilter.
struct LiteralRobocentric {
  reference::RobocentricEkfSlam filter;
  void start(const Pose& pose) { filter.start(pose); }
  void predict(const StepContext&, const Control& control, double duration) {
    filter.predict(control, duration);
  }
  void update(const StepContext&, Scan scan) { filter.update(scan); }
};

struct MapSize {
  std::size_t landmarks, scans;
  double least;  ///< landmarks in the map at the end
};
class RobocentricEkf : public testing::TestWithParam<MapSize> {};

TEST_P(RobocentricEkf, SlowEqualsTheLiteralFilter) {
  const auto& [landmarks, scans, least] = GetParam();
  SmallWorldSettings settings{.seed = 5, .landmarks = landmarks, .scans = scans};
  settings.noise.sigma_bearing = 0.05;
  const SmallWorld world = small_world(settings);
  std::vector<PoseMoments> expected;
  LiteralRobocentric literal{reference::RobocentricEkfSlam(settings.noise)};
  drive_through(literal, world, {4.0, -3.0, 0.5},
                [&](std::size_t) { expected.push_back(literal.filter.pose()); });
  const auto filter = robocentric(settings.noise, landmarks);
  drive_through(*filter, world, {4.0, -3.0, 0.5}, [&](std::size_t s) {
    const PoseMoments& pose = filter->estimate().spread;
    EXPECT_LT(boxminus(pose.mean, expected[s].mean).norm(), 1e-9) << "scan " << s;
    EXPECT_LT((pose.covariance - expected[s].covariance).norm(), 1e-9) << "scan " << s;
  });
  EXPECT_GE(filter->report().map_size, least);
}

INSTANTIATE_TEST_SUITE_P(SmallAndLargeMaps, RobocentricEkf,
                         testing::Values(MapSize{21, 250, 15}, MapSize{300, 50, 101}));

TEST(RobocentricEkfSlam, TellsPoseAndLandmarksAsTheirJointDoes) {
  const SmallWorld world = small_world({.seed = 6, .landmarks = 12, .scans = 120});
  const auto filter = robocentric({}, 12);
  std::vector<std::optional<LandmarkEstimate>> map(12);
  drive_through(*filter, world, {4.0, -3.0, 0.5}, [&](std::size_t) {
    const JointEstimate joint = *filter->joint(12);
    const PoseMoments pose = filter->estimate().spread;
    EXPECT_LT((joint.covariance.topLeftCorner<3, 3>() - pose.covariance).norm(), 1e-9);
    EXPECT_LT((joint.mean.head<2>() - Eigen::Vector2d(pose.mean.x, pose.mean.y)).norm(), 1e-9);
    filter->map(map);
    for (Eigen::Index k = 0; k < 12; ++k) {
      const auto& landmark = map[static_cast<std::size_t>(k)];
      if (!landmark) continue;
      EXPECT_LT((joint.mean.segment<2>(3 + 2 * k) - landmark->mean).norm(), 1e-9);
      EXPECT_LT((joint.covariance.block<2, 2>(3 + 2 * k, 3 + 2 * k) - landmark->covariance).norm(),
                1e-9);
    }
  });
  EXPECT_GT(std::ranges::count_if(map, [](const auto& one) { return one.has_value(); }), 8);
}

}  // namespace
}  // namespace montecarta::filters
