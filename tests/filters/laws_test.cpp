// SPDX-License-Identifier: BSD-3-Clause
#include "filters/factory.hpp"
#include "filters/moments/cloud_moments.hpp"
#include "tests/filters/small_world.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <ostream>
#include <string>
#include <vector>

namespace montecarta {

/// So that a test is listed by the filter's name.
void PrintTo(const FilterKind& kind, std::ostream* out) { *out << kind.name; }

namespace {

std::unique_ptr<SlamFilter> make_default(const FilterKind& kind, std::size_t particles,
                                         const SmallWorldSettings& world,
                                         Association association = Association::known) {
  std::map<std::string, std::string, std::less<>> values;
  for (const FilterOption& option : kind.options) values[option.name] = option.fallback;
  if (kind.has_particles) values["particles"] = std::to_string(particles);
  return kind.make({.belief = world.noise,
                    .association = {.kind = association},
                    .options = FilterOptions(values),
                    .landmarks = world.landmarks});
}

TEST(CloudMoments, MoveAsEveryPoseDoesHoweverWideTheCloud) {
  for (const double width : {0.01, 1.0, kPi}) {
    RngStream draw({3, 0, 0, 0, Draw::test});
    Weights<double> weights(9);
    std::vector<BasicPose<double>> poses(9);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      poses[i] = {10 * draw.normal(), 10 * draw.normal(),
                  wrap(3.0 + width * (2 * draw.uniform() - 1))};
      weights.multiply(i, draw.normal());
    }
    weights.normalise();
    MotionIncrement motion;
    for (int k = 0; k < 5; ++k) motion.advance({3.0, 0.3}, 0.1, Belief{});
    const PoseEstimate closed = CloudMoments(weights, poses).moved_by(motion);
    std::vector<PoseGaussian<double>> moved;
    std::vector<BasicPose<double>> centres;
    for (const auto& pose : poses) {
      moved.push_back(motion.from(pose));
      centres.push_back(moved.back().mean);
    }
    const PoseMoments spread = spread_of(weights, centres), mixture = mixture_of(weights, moved);
    EXPECT_LT((closed.spread.covariance - spread.covariance).norm(), 1e-9) << width;
    EXPECT_LT((closed.mixture->covariance - mixture.covariance).norm(), 1e-9) << width;
    EXPECT_LT(boxminus(closed.spread.mean, spread.mean).norm(), 1e-9) << width;
  }
}

/// Every filter there is, as a newcomer would get it.
class EveryFilter : public testing::TestWithParam<FilterKind> {};

TEST_P(EveryFilter, WalkingBackThroughAncestorsNeverJumpsFartherThanTheVehicleCanMove) {
  if (!GetParam().has_particles) GTEST_SKIP() << "a filter without particles has no genealogy";
  const std::size_t n = 50;
  const SmallWorldSettings settings{.scans = 60};
  const SmallWorld world = small_world(settings);
  const auto filter = make_default(GetParam(), n, settings);
  std::vector<double> poses(3 * n), before(3 * n, 0.0), log_weights(n);
  std::vector<std::uint32_t> ancestors(n);
  bool resampled = false;
  drive_through(*filter, world, Pose(), [&](std::size_t scan) {
    filter->particles({poses, log_weights, ancestors});
    for (std::size_t i = 0; i < n; ++i) {
      const double* then = &before[3 * ancestors[i]];
      const double jump = std::hypot(poses[3 * i] - then[0], poses[3 * i + 1] - then[1]);
      ASSERT_LT(jump, 3.0 * 0.2 + 0.4) << "scan " << scan << ", particle " << i;  // 0.2 s at 3 m/s
    }
    resampled = resampled || filter->report().resampled;
    before = poses;
  });
  EXPECT_TRUE(resampled) << "the law was not put to the test";
}

TEST_P(EveryFilter, StandsStillAtTheOriginOfTheMapWithoutHarm) {
  const SmallWorldSettings settings;
  for (const auto association : {Association::known, Association::nearest}) {
    const auto filter = make_default(GetParam(), 9, settings, association);
    filter->start(Pose());
    const std::vector<Detection> scan{{10.0, 0.3, 0}, {15.0, -0.4, 1}};
    for (std::uint32_t step = 0; step < 20; ++step) {
      const StepContext context(1, 0, step, Parallel::serial());
      filter->predict(context, {0.0, 0.0}, 0.2);
      filter->update(context, scan);
      const PoseMoments now = filter->estimate().spread;
      ASSERT_LT(boxminus(now.mean, Pose()).norm(), 1.5);  // five times its random walk
      ASSERT_TRUE(now.covariance.allFinite());
    }
  }
}

/// Whether a filter adds noise of its own to the motion at every scan, and says so.
bool declares_a_noise_floor(const FilterKind& kind) {
  return std::any_of(kind.options.begin(), kind.options.end(),
                     [](const FilterOption& option) { return option.name == "kernel_floor_xy"; });
}

TEST_P(EveryFilter, LeavesADetectionOutWhoseLandmarkItStandsOn) {
  const SmallWorldSettings settings;
  const bool has_floor = declares_a_noise_floor(GetParam());  // then it steps off the landmark
  const auto filter = make_default(GetParam(), 9, settings);
  filter->start(Pose());
  for (std::uint32_t step = 0; step < 5; ++step) {
    const StepContext context(1, 0, step, Parallel::serial());
    filter->predict(context, {0.0, 0.0}, 0.0);  // no time, so no noise either
    filter->update(context, std::vector<Detection>{{1e-9, 0.0, 0}});
    ASSERT_LT(boxminus(filter->estimate().spread.mean, Pose()).norm(), has_floor ? 0.1 : 1e-6);
  }
  if (!has_floor) {
    EXPECT_EQ(filter->report().numerical_faults, GetParam().has_particles ? 9U : 0U);
  }
}

TEST_P(EveryFilter, ForgetsADifferentRunBefore) {
  const SmallWorldSettings first_settings{.seed = 5, .scans = 70}, settings;
  const SmallWorld first = small_world(first_settings), world = small_world(settings);
  for (const auto association : {Association::known, Association::nearest}) {
    const auto used = make_default(GetParam(), 11, settings, association);
    const auto fresh = make_default(GetParam(), 11, settings, association);
    drive_through(*used, first, Pose(), [](std::size_t) {});
    std::vector<PoseEstimate> estimates;
    std::vector<std::optional<LandmarkEstimate>> map(settings.landmarks), fresh_map(map);
    drive_through(*used, world, Pose(),
                  [&](std::size_t) { estimates.push_back(used->estimate()); });
    drive_through(*fresh, world, Pose(), [&](std::size_t scan) {
      ASSERT_EQ(fresh->estimate().spread.covariance, estimates[scan].spread.covariance);
      ASSERT_EQ(boxminus(fresh->estimate().spread.mean, estimates[scan].spread.mean).norm(), 0.0);
    });
    used->map(map), fresh->map(fresh_map);
    for (std::size_t k = 0; k < map.size(); ++k) {
      ASSERT_EQ(map[k].has_value(), fresh_map[k].has_value());
      ASSERT_TRUE(!map[k] || map[k]->mean == fresh_map[k]->mean);
    }
  }
}

/// Estimates after every scan, with loops over particles spread over `parallel`.
std::vector<PoseMoments> estimates(SlamFilter& filter, const SmallWorld& world,
                                   const Parallel& parallel) {
  std::vector<PoseMoments> found;
  filter.start(Pose());
  for (std::uint32_t step = 0, scan = 0; step < world.itinerary.steps(); ++step) {
    const StepContext context(world.seed, 0, step, parallel);
    filter.predict(context, world.drive.controls[step], world.itinerary.duration(step));
    if (world.itinerary.scan_step[scan] != step) continue;
    filter.update(context, world.drive.scan(scan++));
    found.push_back(filter.estimate().spread);
  }
  return found;
}

TEST_P(EveryFilter, GivesTheSameBitsOnAnyNumberOfThreads) {
  const SmallWorldSettings settings{.scans = 8};
  const SmallWorld world = small_world(settings);
  const Parallel threads(Backend::tbb, 3);
  for (const auto association : {Association::known, Association::nearest}) {
    const auto filter = make_default(GetParam(), 700, settings, association);
    const auto alone = estimates(*filter, world, Parallel::serial());
    const auto together = estimates(*filter, world, threads);
    for (std::size_t scan = 0; scan < alone.size(); ++scan) {
      ASSERT_EQ(boxminus(alone[scan].mean, together[scan].mean).norm(), 0.0) << scan;
      ASSERT_EQ(alone[scan].covariance, together[scan].covariance) << scan;
    }
  }
}

/// The same drive in a world that is turned about the origin and shifted.
SmallWorld turned(const SmallWorld& world, double angle, double x, double y) {
  SmallWorld other = world;
  for (Eigen::Vector2d& f : other.itinerary.landmarks)
    f = Eigen::Rotation2D<double>(angle) * f + Eigen::Vector2d(x, y);
  other.itinerary.start = {x, y, angle};
  return other;
}

TEST_P(EveryFilter, TurningTheWorldTurnsTheEstimate) {
  const SmallWorldSettings settings;
  const SmallWorld world = small_world(settings);
  const double angle = 2.0;
  const SmallWorld other = turned(world, angle, -30.0, 50.0);
  const auto filter = make_default(GetParam(), 30, settings);
  std::vector<PoseEstimate> straight;
  drive_through(*filter, world, Pose(),
                [&](std::size_t) { straight.push_back(filter->estimate()); });
  const Eigen::Rotation2D<double> turn(angle);
  drive_through(*filter, other, other.itinerary.start, [&](std::size_t scan) {
    const PoseMoments& was = straight[scan].spread;
    const PoseMoments now = filter->estimate().spread;
    const Eigen::Vector2d place =
        turn * Eigen::Vector2d(was.mean.x, was.mean.y) + Eigen::Vector2d(-30, 50);
    EXPECT_NEAR((place - Eigen::Vector2d(now.mean.x, now.mean.y)).norm(), 0.0, 1e-6);
    EXPECT_NEAR(wrap(now.mean.heading - was.mean.heading - angle), 0.0, 1e-7);
  });
}

INSTANTIATE_TEST_SUITE_P(All, EveryFilter,
                         testing::ValuesIn(filter_kinds().begin(), filter_kinds().end()),
                         [](const auto& instance) { return instance.param.name; });

std::string text_of(const std::string& path) {
  std::ifstream file(std::string(MONTECARTA_SOURCE_DIR) + "/" + path);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(OwnFilterPage, QuotesTheExampleThatIsCompiled) {
  const std::string example = text_of("filters/dead_reckoning.hpp");
  ASSERT_FALSE(example.empty());
  EXPECT_NE(text_of("filters/README.md").find(example), std::string::npos)
      << "filters/README.md must quote filters/dead_reckoning.hpp as it stands";
}

}  // namespace
}  // namespace montecarta
