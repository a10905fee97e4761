// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/consistency.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace montecarta {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

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
  series.bounds.assign(averages.size(), nees_bounds(30, 3, 0.95));
  return series;
}

Consistency judge(const std::vector<double>& averages) {
  return judge(series_of(averages), every_fifth_of_a_second(averages.size()), 0.95);
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
  EXPECT_EQ(result.verdict, Verdict::consistent);
  EXPECT_EQ(in_words(result), "consistent");
}

TEST(Judge, NamesTheTimeOfALastingExit) {
  std::vector<double> averages(100, 3.0);
  for (std::size_t s = 20; s < 45; ++s) averages[s] = 4.0;
  const Consistency result = judge(averages);
  ASSERT_TRUE(result.lasting_exit.has_value());
  EXPECT_DOUBLE_EQ(*result.lasting_exit, 4.2);
  EXPECT_EQ(in_words(result), "inconsistent from 4.2 s");
}

TEST(Judge, TellsOptimisticFromConservative) {
  std::vector<double> averages(100, 3.0);
  for (std::size_t s = 0; s < 100; s += 5) averages[s] = 4.5;
  EXPECT_EQ(judge(averages).verdict, Verdict::optimistic);
  for (std::size_t s = 0; s < 100; s += 5) averages[s] = 1.5;
  EXPECT_EQ(judge(averages).verdict, Verdict::conservative);
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
}  // namespace montecarta
