// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/nees_bounds.hpp"

#include "engine/errors.hpp"
#include "tests/analysis/statistics/nees_bounds_golden.hpp"

#include <gtest/gtest.h>

namespace montecarta::analysis {
namespace {

TEST(NeesBounds, EqualTheGoldenValues) {
  for (const auto& golden : kGoldenBounds) {
    const Interval bounds = nees_bounds(golden.runs, golden.dimension, golden.level);
    EXPECT_NEAR(bounds.lower, golden.lower, 1e-9) << golden.runs << " x " << golden.dimension;
    EXPECT_NEAR(bounds.upper, golden.upper, 1e-9) << golden.runs << " x " << golden.dimension;
  }
}

TEST(NeesBounds, RefuseWhatIsNoTest) {
  EXPECT_THROW(nees_bounds(0, 3, 0.95), StudyError);
  EXPECT_THROW(nees_bounds(30, 0, 0.95), StudyError);
  for (const double level : {0.0, 1.0, -0.1, 1.5}) {
    EXPECT_THROW(nees_bounds(30, 3, level), StudyError) << level;
  }
}

void expect_match(const IntervalMatch& match, std::uint64_t runs, std::uint64_t dimension,
                  double level) {
  EXPECT_EQ(match.runs, runs);
  EXPECT_EQ(match.dimension, dimension);
  EXPECT_DOUBLE_EQ(match.level, level);
}

// Havangi prints this interval as 95 %: it is the one of 90 % (STATISTICS 3).
TEST(MatchInterval, FindsHavangisIntervalAtNinetyPercent) {
  const auto matches = match_interval(1.3, 2.79);
  ASSERT_FALSE(matches.empty());
  expect_match(matches[0], 20, 2, 0.90);
  EXPECT_TRUE(matches[0].within_digits);
  EXPECT_NEAR(matches[0].deviation, 0.0254651598, 1e-9);
}

TEST(MatchInterval, FindsAnkishansInterval) {
  const auto matches = match_interval(2.19, 3.93);
  ASSERT_FALSE(matches.empty());
  expect_match(matches[0], 30, 3, 0.95);
  EXPECT_NEAR(matches[0].deviation, 3.9378630854 - 3.93, 1e-9);
}

TEST(MatchInterval, FindsEveryGoldenInterval) {
  for (const auto& golden : kGoldenBounds) {
    const auto matches = match_interval(golden.lower, golden.upper);
    ASSERT_FALSE(matches.empty());
    expect_match(matches[0], golden.runs, golden.dimension, golden.level);
    EXPECT_TRUE(matches[0].within_digits);
  }
}

TEST(MatchInterval, SaysWhenNothingFits) {
  const auto matches = match_interval(0.512345, 9.123456);
  ASSERT_FALSE(matches.empty());
  EXPECT_FALSE(matches[0].within_digits);
}

TEST(MatchInterval, RefusesWhatIsNoInterval) {
  EXPECT_THROW(match_interval(3.94, 2.19), StudyError);
  EXPECT_THROW(match_interval(-1.0, 2.0), StudyError);
}

}  // namespace
}  // namespace montecarta::analysis
