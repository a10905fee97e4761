// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/reference_scores.hpp"
#include "analysis/metrics/score.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace montecarta::analysis {
namespace {

using testing::ElementsAre;

/// A run whose aligned RMS and median are `aligned` [m] and whose raw errors are `errors` [m].
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

TEST(ReferenceAnalysis, CountsRunsThatLoseTheMapOrBeatABaseline) {
  const ReferenceAnalysis cell = four_runs();
  EXPECT_EQ(cell.lost(), 1u);  // ten metres are not yet lost
  EXPECT_EQ(cell.better_than(2.0, &ReferenceScores::aligned_rms), 1u);
  EXPECT_EQ(cell.better_than(2.1, &ReferenceScores::aligned_rms), 2u);
}

TEST(ReferenceAnalysis, GivesMeanMiddleAndExtremesOverRuns) {
  const Spread rms = four_runs().over_runs(&ReferenceScores::aligned_rms);
  EXPECT_DOUBLE_EQ(rms.summary.mean, 6.0);
  EXPECT_NEAR(rms.summary.standard_error(), std::sqrt((25.0 + 16.0 + 16.0 + 25.0) / 3.0 / 4.0),
              1e-12);
  EXPECT_DOUBLE_EQ(rms.median, 6.0);
  EXPECT_EQ(rms.least, 1.0);
  EXPECT_EQ(rms.greatest, 11.0);
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
