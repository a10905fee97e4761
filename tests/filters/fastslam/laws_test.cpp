// SPDX-License-Identifier: BSD-3-Clause
#include "filters/factory.hpp"
#include "tests/filters/small_world.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

namespace montecarta {
namespace {

std::unique_ptr<SlamFilter> make_default(const FilterKind& kind, std::size_t particles,
                                         const SmallWorldSettings& world) {
  std::map<std::string, std::string, std::less<>> values;
  for (const FilterOption& option : kind.options) values[option.name] = option.fallback;
  if (kind.has_particles) values["particles"] = std::to_string(particles);
  return kind.make({.belief = world.noise,
                    .association = {},
                    .options = FilterOptions(values),
                    .landmarks = world.landmarks});
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
