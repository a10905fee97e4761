// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/nees_power.hpp"

#include "engine/errors.hpp"
#include "tests/analysis/verdict_studies.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace montecarta::analysis {
namespace {

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

// The promise is kept by the verdict itself: 4 standard errors of 400 studies, and 2 % since the
// plan knows the deviation that the verdict estimates.
void expect_promise_kept(const GaussianLaw& law, std::size_t scans, double power) {
  const NeesPlan plan({.dimension = law.dimension, .scans = law.memory < 1.0 ? scans : 1});
  const std::uint64_t runs = plan.runs_to_find(law.ratio, power);
  const VerdictRates rates = verdict_rates(law, runs, scans, 400);
  const double found = law.ratio > 1.0 ? rates.above : rates.below;
  EXPECT_NEAR(found, plan.found(law.ratio, runs),
              0.02 + 4.0 * std::sqrt(power * (1.0 - power) / 400.0));
}

TEST(NeesPlan, IsWhatSimulatedStudiesHave) {
  expect_promise_kept({.memory = 1.0, .ratio = 1.5}, 2, 0.9);
  expect_promise_kept({.dimension = 2, .memory = 1.0, .ratio = 0.6}, 2, 0.7);
  expect_promise_kept({.ratio = 1.05}, 20, 0.8);
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
