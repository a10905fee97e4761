// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/path_at_fixes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace montecarta::analysis {
namespace {

using testing::ElementsAre;

ReferencePath reference_at(const std::vector<double>& times) {
  ReferencePath path{"gps", times, {}, {}};
  for (const double time : times) {
    path.position.emplace_back(time, 0.0);
    path.heading.push_back(0.1);
  }
  return path;
}

const std::vector<double> kFixTimes = {1.0, 2.0, 4.0};
constexpr Pose kStart{-10.0, 0.0, 0.0};
const std::vector<double> kPathRows = {0.0, 10.0, 0.5,  // row by row
                                       2.0, 10.0, 1.0,  //
                                       6.0, 30.0, 2.0};

TEST(PathAtFixes, UsesOnlyFixesWithinTheDrive) {
  const PathAtFixes fixes(reference_at({-0.1, 0.0, 3.0, 4.0, 4.1}), kFixTimes, kStart);
  EXPECT_THAT(fixes.times(), ElementsAre(0.0, 3.0, 4.0));
  EXPECT_EQ(fixes.positions()[1], Eigen::Vector2d(3.0, 0.0));
  EXPECT_EQ(fixes.headings().size(), 3u);
  EXPECT_EQ(fixes.interpolate(kPathRows).size(), 3u);
}

TEST(PathAtFixes, GoesLinearlyInTimeBetweenRowsAndFromTheStart) {
  const PathAtFixes fixes(reference_at({0.0, 0.25, 1.0, 1.5, 3.0, 4.0}), kFixTimes, kStart);
  const std::vector<Pose> poses = fixes.interpolate(kPathRows);
  const double x[] = {-10.0, -7.5, 0.0, 1.0, 4.0, 6.0};
  const double y[] = {0.0, 2.5, 10.0, 10.0, 20.0, 30.0};
  const double heading[] = {0.0, 0.125, 0.5, 0.75, 1.5, 2.0};
  for (std::size_t f = 0; f < poses.size(); ++f) {
    EXPECT_DOUBLE_EQ(poses[f].x, x[f]) << f;
    EXPECT_DOUBLE_EQ(poses[f].y, y[f]) << f;
    EXPECT_DOUBLE_EQ(poses[f].heading, heading[f]) << f;
  }
}

TEST(PathAtFixes, TurnsTheShorterWayAcrossPi) {
  const std::vector<double> times = {0.0, 1.0};
  const PathAtFixes fixes(reference_at({0.25, 0.75}), times, {});
  const auto poses = fixes.interpolate(std::vector{0.0, 0.0, kPi - 0.1, 0.0, 0.0, -kPi + 0.1});
  EXPECT_NEAR(poses[0].heading, kPi - 0.05, 1e-12);
  EXPECT_NEAR(poses[1].heading, -kPi + 0.05, 1e-12);
}

TEST(PathAtFixes, TakesTheFirstRowWhereItLiesAtTheStartsTime) {
  const std::vector<double> times = {0.0, 1.0};
  const PathAtFixes fixes(reference_at({0.0}), times, kStart);
  EXPECT_EQ(fixes.interpolate(std::vector(6, 7.0))[0].x, 7.0);
}

}  // namespace
}  // namespace montecarta::analysis
