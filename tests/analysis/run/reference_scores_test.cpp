// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/reference_scores.hpp"

#include "analysis/run/measured_run.hpp"
#include "analysis/study/reference_sums.hpp"
#include "analysis/study/score_table.hpp"
#include "engine/random/stream.hpp"
#include "tests/analysis/synthetic_runs.hpp"

#include <gmock/gmock.h>

#include <cmath>

namespace montecarta::analysis {
namespace {

using testing::ElementsAre;

/// An arc of 100 rows, one a second.
std::vector<double> arc() {
  std::vector<double> path;
  for (const double t : scan_times(100)) {
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
  return measure_against(PathAtFixes(fixes, scan_times(100), {}), arc());
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

/// A run with this aligned RMS and median [m] and these raw errors [m].
ReferenceRun run_with(double aligned, const std::vector<double>& errors) {
  ReferenceRun run;
  run.scores.rms = errors.front();
  run.scores.aligned_rms = run.scores.aligned_median = aligned;
  for (const double error : errors) run.squared_error.push_back(error * error);
  return run;
}

ReferenceAnalysis four_runs() {
  ReferenceAccumulator sums;
  sums.add(run_with(1.0, {1.0, 0.0}));
  sums.add(run_with(2.0, {7.0, 0.0}));
  sums.add(run_with(10.0, {5.0, 4.0}));
  sums.add(run_with(11.0, {5.0, 4.0}));
  return sums.result();
}

TEST(ReferenceAnalysis, CountsRunsThatLoseTheMapAndGivesMeanMiddleAndExtremes) {
  const ReferenceAnalysis cell = four_runs();
  EXPECT_EQ(cell.lost(), 1u);  // ten metres are not yet lost
  const Spread rms = four_runs().over_runs(&ReferenceScores::aligned_rms);
  EXPECT_DOUBLE_EQ(rms.summary.mean, 6.0);
  EXPECT_NEAR(rms.summary.standard_error(), std::sqrt((25.0 + 16.0 + 16.0 + 25.0) / 3.0 / 4.0),
              1e-12);
  EXPECT_DOUBLE_EQ(rms.median, 6.0);
  EXPECT_EQ(rms.least, 1.0);
  EXPECT_EQ(rms.greatest, 11.0);
}

/// A cell whose runs, with these numbers, have these raw RMS [m].
CellAnalysis cell_with(const std::vector<std::uint64_t>& numbers, const std::vector<double>& rms) {
  CellAnalysis cell;
  cell.runs = numbers;
  ReferenceAnalysis analysis;
  for (const double one : rms) analysis.runs.push_back(run_with(1.0, {one}).scores);
  cell.findings.put(ReferenceAnalyses{analysis});
  return cell;
}

TEST(RunsAgainst, CompareWithTheMeanOnOneDriveAndRunByRunOnDrivesOfTheirOwn) {
  const auto against = [](const CellAnalysis& cell, const CellAnalysis& baseline,
                          DrivesOfRuns drives) {
    const RunsAgainst found = runs_against(cell, baseline, &ReferenceScores::rms, drives);
    return std::pair(found.better, found.equal);
  };
  const CellAnalysis baseline = cell_with({0, 1, 2}, {0.1, 0.7, 0.1});  // the mean rounds
  const CellAnalysis same = cell_with({0, 1, 2}, {0.1, 0.7, 0.1 * (1.0 + 1e-15)});
  EXPECT_EQ(against(same, baseline, DrivesOfRuns::own), std::pair(0UL, 3UL));
  EXPECT_EQ(against(same, baseline, DrivesOfRuns::same), std::pair(2UL, 0UL));
  const CellAnalysis other = cell_with({0, 1, 2}, {0.05, 0.8, 0.1});
  EXPECT_EQ(against(other, baseline, DrivesOfRuns::own), std::pair(1UL, 1UL));
  const CellAnalysis failed =
      cell_with({0, 2}, {0.1, 0.2});  // run 1 is better than one that failed
  EXPECT_EQ(against(other, failed, DrivesOfRuns::own), std::pair(3UL, 0UL));
  const CellAnalysis equal = cell_with({0, 1, 2}, {0.7, 0.7, 0.7});
  EXPECT_EQ(against(equal, equal, DrivesOfRuns::same), std::pair(0UL, 3UL));
}

TEST(ReferenceAnalysis, IsOfTheRunsThatHaveFixes) {
  ReferenceAnalysis cell = four_runs();
  cell.runs.emplace_back();  // its drive has none
  EXPECT_EQ(cell.with_fixes(), 4u);
  EXPECT_EQ(cell.lost(), 1u);
  EXPECT_DOUBLE_EQ(cell.over_runs(&ReferenceScores::aligned_rms).median, 6.0);
  cell.runs.back().gated_share = 0.0;  // it has some, and its estimates are no numbers
  EXPECT_EQ(cell.with_fixes(), 5u);
  EXPECT_EQ(cell.lost(), 2u);
}

TEST(ReferenceAnalysis, TakesTheRootOfTheMeanSquareAtEveryFix) {
  EXPECT_THAT(four_runs().error_over_time, ElementsAre(5.0, std::sqrt(8.0)));
}

TEST(ReferenceAnalysis, GivesRunsTheScoresThatStudiesName) {
  ScoreTable scores;
  for (const ReferenceScores& each : four_runs().runs) {
    MeasuredRun run;
    run.references = {{each, {}, {}}, {{}, {}, {}}};
    scores.add(run);
  }
  EXPECT_EQ(scores.column("reference_rms")[1], 7.0);
  EXPECT_EQ(scores.column("reference_aligned_rms")[1], 2.0);
  EXPECT_EQ(scores.column("reference_aligned_median")[3], 11.0);
}

TEST(Spread, IsUnknownOfNoneAndOfNaN) {
  EXPECT_TRUE(std::isnan(spread_of({}).median));
  const Spread spread = spread_of(std::vector{1.0, std::nan(""), 2.0});
  EXPECT_EQ(spread.summary.n, 3u);
  EXPECT_TRUE(std::isnan(spread.summary.mean));
  EXPECT_TRUE(std::isnan(spread.least));
  EXPECT_EQ(median_of({3.0, 1.0, 2.0}), 2.0);
}

}  // namespace
}  // namespace montecarta::analysis
