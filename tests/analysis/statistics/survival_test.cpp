// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/survival.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace montecarta::analysis {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
const std::vector<double> kTimes = {1.0, 2.0, 3.0, 4.0, 5.0};

TEST(Survival, CountsTheRunsThatAreStillRight) {
  const std::vector<double> ends = {2.0, kNever, 4.0, 2.0};
  const Survival found = survival_of(ends, kTimes, 0.95);
  EXPECT_EQ(found.share, (std::vector<double>{1.0, 0.5, 0.5, 0.25, 0.25}));
  EXPECT_EQ(found.runs, 4u);
  EXPECT_EQ(found.lost, 3u);
  EXPECT_EQ(found.median, 2.0);
}

// Wilson's interval of 5 of 10 at 95 % is [0.2366, 0.7634] (Newcombe 1998).
TEST(Survival, GivesWilsonsIntervals) {
  std::vector<double> ends(10, kNever);
  std::fill_n(ends.begin(), 5, 1.0);
  const Survival found = survival_of(ends, kTimes, 0.95);
  EXPECT_NEAR(found.interval[0].lower, 0.2366, 1e-4);
  EXPECT_NEAR(found.interval[0].upper, 0.7634, 1e-4);
}

// Of ten values the second and the ninth hold the median with 97.9 %, the third and eighth with 89
// %.
TEST(Survival, HoldsTheMedianBetweenOrderStatistics) {
  const std::vector<double> ends = {1, 2, 3, 4, 5, 6, 7, 8, 9, kNever};
  const Survival found = survival_of(ends, kTimes, 0.95);
  EXPECT_EQ(found.median, 5.0);
  EXPECT_EQ(found.median_interval.lower, 2.0);
  EXPECT_EQ(found.median_interval.upper, 9.0);
  EXPECT_EQ(survival_of(ends, kTimes, 0.9).median_interval.lower, 2.0);
  EXPECT_EQ(survival_of(ends, kTimes, 0.89).median_interval.lower, 3.0);
}

TEST(Survival, SaysNeverWhereMostRunsLast) {
  const std::vector<double> ends = {1.0, kNever, kNever, kNever, kNever};
  const Survival found = survival_of(ends, kTimes, 0.95);
  EXPECT_EQ(found.median, kNever);
  EXPECT_EQ(found.median_interval.upper, kNever);
  EXPECT_EQ(survival_of({}, kTimes, 0.95).runs, 0u);
}

}  // namespace
}  // namespace montecarta::analysis
