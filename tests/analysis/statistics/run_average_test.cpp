// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/run_average.hpp"

#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace montecarta::analysis {
namespace {

constexpr double kDeviate = 1.96;

AverageLaw law_of(const std::vector<double>& runs) { return average_law(runs, 3, kDeviate, 1.0); }

// The average over one scan is the average NEES.
TEST(AverageLaw, IsThatOfTheChiSquareWhereRunsAreOneScanLong) {
  RngStream draw({5, 0, 0, 0, Draw::test});
  std::vector<double> nees(2000);
  for (double& value : nees) {
    value = 0.0;
    for (int i = 0; i < 3; ++i) {
      const double normal = draw.normal();
      value += normal * normal;
    }
  }
  const Interval exact = nees_bounds(2000, 3, 0.95), found = law_of(nees).bounds();
  EXPECT_NEAR(3.0 * found.lower, exact.lower, 0.01);
  EXPECT_NEAR(3.0 * found.upper, exact.upper, 0.01);
  EXPECT_FALSE(is_overdispersed(nees, 3));
}

TEST(AverageLaw, IsNeverWiderThanThatOfOneScan) {
  std::vector<double> astray(30, 3.0), beyond = astray;
  astray[4] = 1e20;
  beyond[4] = std::numeric_limits<double>::infinity();
  EXPECT_LT(3.0 * law_of(astray).bounds().upper, 10.0);
  EXPECT_TRUE(is_overdispersed(astray, 3));
  EXPECT_EQ(law_of(beyond).bounds().upper, law_of(astray).bounds().upper);
  EXPECT_TRUE(is_overdispersed(beyond, 3));
  EXPECT_TRUE(std::isinf(law_of({3.0, 3.0}).bounds().upper));
}

// The coefficient of variation of gamma samples is independent of their mean (Lukacs), so that runs
// which lie low by chance do not narrow the bounds.
TEST(AverageLaw, DoesNotDependOnTheScaleOfTheRuns) {
  const Interval once = law_of({2.0, 3.5, 2.5, 3.0}).bounds();
  const Interval twice = law_of({4.0, 7.0, 5.0, 6.0}).bounds();
  EXPECT_NEAR(twice.lower, once.lower, 1e-12);
  EXPECT_NEAR(twice.upper, once.upper, 1e-12);
}

TEST(AverageLaw, ReachesFartherDownWhereRunsAreMoreSkewed) {
  AverageLaw law{.variation = 0.3, .runs = 20, .deviate = 2.0};
  const Interval gamma = law.bounds();
  law.skew = 1.4;
  EXPECT_LT(law.bounds().lower, gamma.lower);
  EXPECT_LT(law.bounds().upper, gamma.upper);
}

// Of many runs all is normal: 1.96 and 1.96 + 1.282 deviations of sqrt(0.1 / 1e6).
TEST(LeastRatios, AddThePowersDeviate) {
  const AverageLaw law{.variation = 0.1, .runs = 1e6, .deviate = kDeviate};
  const Interval found = least_ratios(law, 0.9);
  EXPECT_NEAR(found.upper, 1.0 + 3.2415 * std::sqrt(1e-7), 1e-5);
  EXPECT_NEAR(found.lower, 1.0 - 3.2415 * std::sqrt(1e-7), 1e-5);
}

// (2 x 1.96 / log 1.1)^2 x 0.1 = 169.2 by the normal law.
TEST(RunsThatDecide, MakeTheIntervalNoLongerThanTheMargin) {
  AverageLaw law{.variation = 0.1, .runs = 10, .deviate = kDeviate};
  const std::uint64_t enough = runs_that_decide(law, 1.1);
  EXPECT_NEAR(static_cast<double>(enough), 169.0, 2.0);
  law.runs = static_cast<double>(enough);
  EXPECT_LE(law.bounds().upper / law.bounds().lower, 1.1);
  law.runs -= 1.0;
  EXPECT_GT(law.bounds().upper / law.bounds().lower, 1.1);
  EXPECT_EQ(runs_that_decide({.variation = 1e-9, .runs = 10, .deviate = kDeviate}, 1.1), 3u);
}

}  // namespace
}  // namespace montecarta::analysis
