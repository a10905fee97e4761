// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/reference_scores.hpp"

#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace montecarta::analysis {
namespace {

/// An arc of 100 rows, one a second.
std::vector<double> row_times() {
  std::vector<double> times;
  for (std::size_t k = 0; k < 100; ++k) times.push_back(static_cast<double>(k + 1));
  return times;
}

std::vector<double> arc() {
  std::vector<double> path;
  for (const double t : row_times()) {
    const double turn = 0.03 * t;
    path.insert(path.end(), {30.0 * std::sin(turn), 30.0 - 30.0 * std::cos(turn), wrap(turn)});
  }
  return path;
}

/// Fixes halfway between rows, on the line that the estimate takes there.
ReferencePath fixes_on(const std::vector<double>& path) {
  ReferencePath fixes{"gps", {}, {}, {}};
  for (std::size_t k = 0; k + 1 < path.size() / 3; ++k) {
    const double* row = path.data() + 3 * k;
    fixes.time.push_back(static_cast<double>(k) + 1.5);
    fixes.position.emplace_back(0.5 * (row[0] + row[3]), 0.5 * (row[1] + row[4]));
    fixes.heading.push_back(wrap(row[2] + 0.5 * wrap(row[5] - row[2])));
  }
  return fixes;
}

ReferenceRun measured(const ReferencePath& fixes) {
  return measure_against(PathAtFixes(fixes, row_times(), {}), arc());
}

TEST(ReferenceScores, AreZeroWithoutNoise) {
  const ReferenceRun run = measured(fixes_on(arc()));
  EXPECT_NEAR(run.scores.rms, 0.0, 1e-12);
  EXPECT_NEAR(run.scores.aligned_rms, 0.0, 1e-12);
  EXPECT_NEAR(run.scores.heading_rmse, 0.0, 1e-12);
  EXPECT_EQ(run.squared_error.size(), 99u);
}

TEST(ReferenceScores, AlignmentTakesAwayAWrongStartOnly) {
  const RigidMotion motion{0.7, {12.0, -5.0}};
  ReferencePath turned = fixes_on(arc()), mirrored = turned;
  for (Eigen::Vector2d& position : turned.position) position = motion(position);
  for (Eigen::Vector2d& position : mirrored.position) position.y() = -position.y();
  EXPECT_GT(measured(turned).scores.rms, 5.0);
  EXPECT_NEAR(measured(turned).scores.aligned_rms, 0.0, 1e-11);
  EXPECT_NEAR(measured(turned).scores.aligned_median, 0.0, 1e-11);
  EXPECT_GT(measured(mirrored).scores.aligned_rms, 1.0);
}

TEST(ReferenceScores, KnowDistancesByHand) {
  ReferencePath fixes = fixes_on(arc());
  for (std::size_t f = 0; f < fixes.position.size(); ++f) {
    fixes.position[f].x() += f % 2 == 0 ? 3.0 : -3.0;
    fixes.heading[f] = wrap(fixes.heading[f] + 0.2);
  }
  const ReferenceScores scores = measured(fixes).scores;
  EXPECT_NEAR(scores.rms, 3.0, 1e-12);
  EXPECT_NEAR(scores.median, 3.0, 1e-12);
  EXPECT_NEAR(scores.heading_rmse, 0.2, 1e-12);
  EXPECT_EQ(scores.gated_share, 1.0);
}

TEST(ReferenceScores, TheGateLeavesOneWildFixOut) {
  ReferencePath fixes = fixes_on(arc());
  for (Eigen::Vector2d& position : fixes.position) position.x() += 1.0;
  fixes.position[40].y() += 136.0;
  const ReferenceScores scores = measured(fixes).scores;
  EXPECT_GT(scores.rms, 13.0);
  EXPECT_NEAR(scores.median, 1.0, 1e-12);
  EXPECT_NEAR(scores.gated_rms, 1.0, 1e-12);
  EXPECT_NEAR(scores.gated_share, 98.0 / 99.0, 1e-12);
  EXPECT_LT(scores.aligned_gated_rms, 0.2 * scores.aligned_rms);
}

TEST(ReferenceScores, AFilterThatIsWrongEverywhereIsSoWithinTheGate) {
  ReferencePath fixes = fixes_on(arc());
  RngStream draw({.seed = 2, .purpose = Draw::test});
  for (Eigen::Vector2d& position : fixes.position) position.x() += 50.0 * draw.normal();
  const ReferenceScores scores = measured(fixes).scores;
  EXPECT_GT(scores.gated_rms, 30.0);
  EXPECT_TRUE(scores.lost());
  EXPECT_FALSE(measured(fixes_on(arc())).scores.lost());
}

TEST(ReferenceScores, AFilterThatLeavesThePathKeepsFewFixes) {
  ReferencePath fixes = fixes_on(arc());
  for (std::size_t f = 6 * fixes.position.size() / 10; f < fixes.position.size(); ++f)
    fixes.position[f].x() += 200.0;
  const ReferenceScores scores = measured(fixes).scores;
  EXPECT_NEAR(scores.gated_share, 0.6, 0.02);
  EXPECT_GT(scores.rms, 100.0);
}

TEST(ReferenceScores, AreUnknownWithoutFixesOrHeadings) {
  ReferencePath fixes = fixes_on(arc());
  fixes.heading.clear();
  EXPECT_TRUE(std::isnan(measured(fixes).scores.heading_rmse));
  for (double& time : fixes.time) time += 1000.0;
  EXPECT_TRUE(std::isnan(measured(fixes).scores.rms));
}

}  // namespace
}  // namespace montecarta::analysis
