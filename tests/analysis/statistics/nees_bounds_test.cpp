// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/nees_bounds.hpp"

#include "analysis/statistics/nees_power.hpp"
#include "engine/errors.hpp"
#include "tests/analysis/statistics/nees_bounds_golden.hpp"
#include "tests/analysis/verdict_studies.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>

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

// Where runs are many all is normal: the average has a deviation of sqrt(2 / (3 x 100 N)), the test
// leaves 2.05 of it on either side (WholeRunTest.IsSidaks...), and 90 % is 1.2816 of them.
TEST(NeesPlan, IsTheNormalLawWhereRunsAreMany) {
  const NeesPlan plan({.dimension = 3, .scans = 100});
  const double variance = 2.0 / 300.0, step = std::log(1.02);
  const double to_find = std::pow((2.05 + 1.2816) / step, 2) * variance;
  EXPECT_NEAR(static_cast<double>(plan.runs_to_find(1.02, 0.9)) / to_find, 1.0, 0.06);
  const double to_decide = std::pow(2.0 * 2.05 / step, 2) * variance;
  EXPECT_NEAR(static_cast<double>(plan.runs_to_decide(1.02)) / to_decide, 1.0, 0.06);
  // Of a consistent filter either end may be beyond the margin, each in 5 % of studies: 1.6449.
  const double to_show = std::pow((2.05 + 1.6449) / step, 2) * variance;
  EXPECT_NEAR(static_cast<double>(plan.runs_to_show(1.02, 0.9)) / to_show, 1.0, 0.06);
}

TEST(NeesPlan, NamesTheFewest) {
  for (const double ratio : {0.5, 0.9, 1.2, 3.0}) {
    for (const std::uint64_t scans : {1U, 30U}) {
      const NeesPlan plan({.dimension = 2, .scans = scans});
      const std::uint64_t runs = plan.runs_to_find(ratio, 0.8);
      EXPECT_GE(plan.found(ratio, runs), 0.8) << ratio << ' ' << scans;
      EXPECT_LT(plan.found(ratio, runs - 1), 0.8) << ratio << ' ' << scans;
    }
  }
}

// The promise is kept by the verdict itself: 4 standard errors, and 3 % since the plan knows the
// deviation that the verdict estimates.
void expect_promise_kept(const GaussianLaw& law, std::size_t scans, double power) {
  const NeesPlan plan({.dimension = law.dimension, .scans = law.memory < 1.0 ? scans : 1});
  const std::uint64_t runs = plan.runs_to_find(law.ratio, power);
  const std::uint64_t studies = studies_of_a_line(400);
  const VerdictRates rates = verdict_rates(law, runs, scans, studies);
  const double found = law.ratio > 1.0 ? rates.above : rates.below;
  std::printf("%zu components, %s, ratio %.2f: %llu runs, promised %.1f %%, found %.1f %%\n",
              law.dimension, law.memory < 1.0 ? "independent scans" : "constant", law.ratio,
              static_cast<unsigned long long>(runs), 100.0 * plan.found(law.ratio, runs),
              100.0 * found);
  EXPECT_NEAR(found, plan.found(law.ratio, runs),
              0.03 + 4.0 * std::sqrt(power * (1.0 - power) / static_cast<double>(studies)));
}

// MONTECARTA_STUDIES=2000 gives the table of STATISTICS 17.
TEST(NeesPlan, IsWhatSimulatedStudiesHave) {
  for (const std::size_t dimension : {1u, 2u, 3u, 6u}) {
    expect_promise_kept({.dimension = dimension, .memory = 1.0, .ratio = 1.5}, 2, 0.9);
    expect_promise_kept({.dimension = dimension, .memory = 1.0, .ratio = 0.6}, 2, 0.9);
    expect_promise_kept({.dimension = dimension, .ratio = 1.1}, 20, 0.9);
  }
}

// Of three runs of one component no double holds the tail that the test asks for.
TEST(NeesPlan, AnswersForEveryDimension) {
  for (const std::size_t dimension : {1u, 2u, 3u, 6u, 1000u}) {
    const NeesPlan plan({.dimension = dimension});
    EXPECT_EQ(plan.found(3.0, 3) >= 0.0, true) << dimension;
    std::uint64_t more = plan.runs_to_find(1.05, 0.9);
    for (const double ratio : {1.2, 1.5, 3.0}) {
      const std::uint64_t runs = plan.runs_to_find(ratio, 0.9);
      EXPECT_LE(runs, more) << dimension << ' ' << ratio;
      more = runs;
    }
    EXPECT_GE(plan.runs_to_find(0.8, 0.9), plan.runs_to_find(0.3, 0.9)) << dimension;
  }
}

TEST(NeesPlan, ShowsAConsistentFilterAsOftenAsItSays) {
  const NeesPlan plan({.dimension = 3, .scans = 20});
  const std::uint64_t runs = plan.runs_to_show(1.1, 0.8);
  EXPECT_NEAR(verdict_rates({}, runs, 20, 400).answer(Verdict::consistent), 0.8, 0.1);
}

TEST(NeesPlan, RefusesWhatIsNoQuestion) {
  const NeesPlan plan({});
  for (const double ratio : {1.0, 0.0, -2.0, std::nan(""), HUGE_VAL}) {
    EXPECT_THROW(plan.runs_to_find(ratio, 0.9), StudyError) << ratio;
  }
  for (const double power : {0.0, 1.0, -0.5, std::nan("")}) {
    EXPECT_THROW(plan.runs_to_find(1.5, power), StudyError) << power;
  }
  EXPECT_THROW(plan.runs_to_decide(1.0), StudyError);
  EXPECT_THROW(NeesPlan({.dimension = 0}), StudyError);
  EXPECT_THROW(NeesPlan({.level = 1.0}), StudyError);
  EXPECT_THROW(NeesPlan({.scans = 0}), StudyError);
  EXPECT_THROW(NeesPlan({.scans = kMostPlannedScans + 1}), StudyError);
  EXPECT_THROW(plan.runs_to_find(1.0000001, 0.9), StudyError);
}

}  // namespace
}  // namespace montecarta::analysis
