// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/consistency.hpp"

#include "analysis/statistics/means.hpp"
#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {
namespace {

std::vector<double> every_fifth_of_a_second(std::size_t scans) {
  std::vector<double> times;
  for (std::size_t s = 0; s < scans; ++s) times.push_back(0.2 * static_cast<double>(s + 1));
  return times;
}

/// A series of 30 runs of three components with these averages.
NeesSeries series_of(const std::vector<double>& averages) {
  NeesSeries series;
  series.dimension = 3;
  series.average = averages;
  series.median = averages;
  series.runs.assign(averages.size(), 30);
  series.trimmed = averages;
  series.bounds.assign(averages.size(), nees_bounds(30, 3, 0.95));
  series.average_deviate = 2.364;  // Student's t of 30 runs, 97.5 %
  series.whole_run_bounds.assign(averages.size(), nees_bounds(30, 3, 0.9999));
  return series;
}

Consistency judge(const std::vector<double>& averages) {
  return judge(series_of(averages), every_fifth_of_a_second(averages.size()));
}

TEST(FirstLasting, FindsTheBeginningOfTheFirstLongEnoughStretch) {
  std::vector<bool> above(100, false);
  for (std::size_t s = 10; s < 34; ++s) above[s] = true;  // one short
  for (std::size_t s = 40; s < 80; ++s) above[s] = true;
  EXPECT_EQ(first_lasting(above, 25), 40u);
  EXPECT_EQ(first_lasting(above, 24), 10u);
  EXPECT_EQ(first_lasting(above, 41), std::nullopt);
  EXPECT_EQ(first_lasting(std::vector<bool>(25, true), 25), 0u);
  EXPECT_EQ(first_lasting({}, 25), std::nullopt);
}

TEST(Judge, CountsSharesOfScans) {
  std::vector<double> averages(100, 3.0);
  averages[3] = 5.0;
  averages[50] = averages[51] = 1.0;
  const Consistency result = judge(averages);
  EXPECT_DOUBLE_EQ(result.share_inside, 0.97);
  EXPECT_DOUBLE_EQ(result.share_above, 0.01);
  EXPECT_DOUBLE_EQ(result.share_below, 0.02);
}

TEST(Judge, IsNotMovedByScansOutsideThePointwiseBandAlone) {
  std::vector<double> averages(100, 3.0);
  averages[3] = 4.2;
  for (std::size_t s = 50; s < 80; ++s) averages[s] = 4.0;  // goes together: one piece of chance
  const Consistency result = judge(averages);
  EXPECT_EQ(result.verdict, Verdict::consistent);
  EXPECT_EQ(in_words(result), "consistent");
  EXPECT_TRUE(result.lasting_exit.has_value());
}

TEST(Judge, NamesTheTimeOfALastingExit) {
  std::vector<double> averages(100, 3.0);
  for (std::size_t s = 20; s < 45; ++s) averages[s] = 5.2;
  const Consistency result = judge(averages);
  ASSERT_TRUE(result.lasting_exit.has_value());
  EXPECT_DOUBLE_EQ(*result.lasting_exit, 4.2);
  EXPECT_DOUBLE_EQ(*result.above_from, 4.2);
  EXPECT_FALSE(result.below_from.has_value());
  EXPECT_EQ(in_words(result), "inconsistent from 4.2 s");
}

TEST(Judge, TellsOptimisticFromConservative) {
  std::vector<double> averages(100, 3.0);
  averages[7] = 5.2;
  EXPECT_EQ(judge(averages).verdict, Verdict::optimistic);
  averages[7] = 1.2;
  EXPECT_EQ(judge(averages).verdict, Verdict::conservative);
}

TEST(Judge, UsesTheAverageOverTheRunWhereNoScanIsFarOff) {
  NeesSeries series = series_of(std::vector<double>(100, 3.4));
  for (int run = 0; run < 30; ++run) series.run_averages.push_back(3.4 + 0.02 * (run % 2));
  EXPECT_EQ(judge(series, every_fifth_of_a_second(100)).verdict, Verdict::optimistic);
  std::ranges::fill(series.average, 2.7);
  EXPECT_EQ(judge(series, every_fifth_of_a_second(100)).verdict, Verdict::conservative);
}

// The average over one scan is the average NEES.
TEST(RunAverageBounds, AreThoseOfTheChiSquareWhereRunsAreOneScanLong) {
  RngStream draw({5, 0, 0, 0, Draw::test});
  std::vector<double> nees(2000);
  for (double& value : nees) {
    value = 0.0;
    for (int i = 0; i < 3; ++i) {
      const double normal = draw.normal();
      value += normal * normal;
    }
  }
  const Interval exact = nees_bounds(2000, 3, 0.95);
  const Interval found = run_average_bounds(nees, 3, 1.96);
  EXPECT_NEAR(found.lower, exact.lower, 0.01);
  EXPECT_NEAR(found.upper, exact.upper, 0.01);
}

TEST(RunAverageBounds, AreNeverWiderThanThoseOfOneScan) {
  const std::vector<double> astray = {1.0, 2.0, 1e20, 3.0, 4.0};
  EXPECT_LT(run_average_bounds(astray, 3, 1.96).upper, 10.0);
  const std::vector<double> beyond = {1.0, 2.0, std::numeric_limits<double>::infinity(), 3.0, 4.0};
  EXPECT_EQ(run_average_bounds(beyond, 3, 1.96).upper, run_average_bounds(astray, 3, 1.96).upper);
  EXPECT_TRUE(std::isinf(run_average_bounds(std::vector<double>{3.0, 3.0}, 3, 1.96).upper));
}

// The coefficient of variation of gamma samples is independent of their mean (Lukacs), so that runs
// which lie low by chance do not narrow the bounds.
TEST(RunAverageBounds, DoNotDependOnTheScaleOfTheRuns) {
  const std::vector<double> runs = {2.0, 3.5, 2.5, 3.0}, twice = {4.0, 7.0, 5.0, 6.0};
  const Interval bounds = run_average_bounds(runs, 3, 1.96);
  EXPECT_NEAR(run_average_bounds(twice, 3, 1.96).lower, bounds.lower, 1e-12);
  EXPECT_NEAR(run_average_bounds(twice, 3, 1.96).upper, bounds.upper, 1e-12);
}

TEST(ExpectedValues, AreThoseOfTheChiSquare) {
  EXPECT_NEAR(expected_median(3), 2.36597, 1e-5);
  EXPECT_NEAR(expected_median(1), 0.45494, 1e-5);
  // By adding up quantiles: scipy.stats.chi2.ppf of (k + 0.5) / n between 0.1 and 0.9.
  EXPECT_NEAR(expected_trimmed(3), 2.64820, 1e-4);
}

TEST(Judge, LeavesOutScansWithoutARunAndBreaksStretchesThere) {
  std::vector<double> averages(60, 9.0);
  averages[20] = averages[40] = kNaN;
  const Consistency result = judge(averages);
  EXPECT_DOUBLE_EQ(result.share_above, 1.0);
  EXPECT_FALSE(result.lasting_exit.has_value());
  EXPECT_DOUBLE_EQ(result.mean, 9.0);
}

TEST(Judge, DoesNotJudgeNothing) {
  EXPECT_EQ(judge(std::vector<double>(30, kNaN)).verdict, Verdict::untested);
  EXPECT_EQ(in_words(Consistency{}), "not tested");
}

}  // namespace
}  // namespace montecarta::analysis
