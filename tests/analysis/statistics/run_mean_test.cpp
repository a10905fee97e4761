// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/run_mean.hpp"

#include "analysis/statistics/distributions.hpp"
#include "tests/doubles/matchers.hpp"

#include <cmath>

namespace montecarta::analysis {
namespace {

Summary summary(std::size_t n, double mean, double sd, double skewness) {
  return {.n = n, .mean = mean, .sd = sd, .skewness = skewness};
}

TEST(SummaryOf, HasTheSkewnessByHandAlsoOfMergedValues) {
  SummaryOf all, first, second;
  const std::vector<double> values = {1.0, 2.0, 4.0, 9.0};
  for (std::size_t k = 0; k < values.size(); ++k) {
    all.add(values[k]);
    (k < 1 ? first : second).add(values[k]);
  }
  first.merge(second);
  // Mean 4, squared deviations 9 + 4 + 0 + 25, cubes -27 - 8 + 0 + 125.
  const double sd = std::sqrt(38.0 / 3.0);
  const double skewness = 90.0 / std::pow(sd, 3) * 4.0 / (3.0 * 2.0);
  EXPECT_NEAR(all.result().skewness, skewness, 1e-14);
  EXPECT_NEAR(first.result().skewness, skewness, 1e-14);
  EXPECT_TRUE(std::isnan(summary_of(std::span(values).first(2)).skewness));
  EXPECT_EQ(summary_of(std::vector<double>(5, 3.0)).skewness, 0.0);
}

TEST(RunMean, IsStudentsOfSymmetricValues) {
  const Summary runs = summary(25, 0.3, 1.0, 5.0);
  const RunMean mean = RunMean::of_symmetric(runs);
  EXPECT_NEAR(mean.p_value(0.0), t_p_value(1.5, 24.0), 1e-14);
  EXPECT_NEAR(mean.interval(0.95).lower, runs.interval(0.95).lower, 1e-14);
  EXPECT_NEAR(mean.interval(0.95).upper, runs.interval(0.95).upper, 1e-14);
  EXPECT_NEAR(mean.p_value_above_zero(), 0.5 * t_p_value(1.5, 24.0), 1e-14);
  EXPECT_EQ(RunMean::of_symmetric(summary(25, -0.3, 1.0, 0.0)).p_value_above_zero(), 1.0);
}

// Hall's transformation by hand: 100 runs, mean 1.2 of expected 1, deviation 1, skewness 3.
TEST(RunMean, CorrectsARatioForSkewness) {
  const RunMean mean = RunMean::of_ratio(summary(100, 1.2, 1.0, 3.0));
  const double most = 3.0 - std::sqrt(0.06);
  const double above = 10.0 * ((std::pow(1.0 + most * 0.2 / 3.0, 3) - 1.0) / most + most / 600.0);
  EXPECT_NEAR(mean.p_value(1.0), t_p_value(above, 99.0), 1e-12);
  const double g = 3.0 * 1.1 + std::sqrt(0.06), x = 1.2 - 1.4;
  const double below = 10.0 * ((std::pow(1.0 + g * x / 3.0, 3) - 1.0) / g + g / 600.0);
  EXPECT_NEAR(mean.p_value(1.4), t_p_value(below, 99.0), 1e-12);
}

// The interval holds the expectations that are not rejected.
TEST(RunMean, HasTheIntervalThatItsTestsLeave) {
  for (const double skewness : {0.0, 2.0, 6.0}) {
    for (const std::size_t n : {5, 20, 200}) {
      const RunMean mean = RunMean::of_ratio(summary(n, 1.3, 0.7, skewness));
      const Interval found = mean.interval(0.99);
      EXPECT_NEAR(mean.p_value(found.lower), 0.01, 1e-9) << skewness << ", " << n;
      EXPECT_NEAR(mean.p_value(found.upper), 0.01, 1e-9) << skewness << ", " << n;
      const RunMean product = RunMean::of_product(summary(n, 0.3, 1.0, skewness));
      const Interval of_product = product.interval(0.99);
      if (std::isfinite(of_product.lower)) {
        EXPECT_NEAR(product.p_value(of_product.lower), 0.01, 1e-9) << skewness << ", " << n;
      }
    }
  }
}

// Law: a ratio that is q times as large has q times the interval.
TEST(RunMean, ScalesWithTheRatio) {
  const Interval one = RunMean::of_ratio(summary(30, 1.0, 0.8, 1.0)).interval(0.95);
  const Interval four = RunMean::of_ratio(summary(30, 4.0, 3.2, 1.0)).interval(0.95);
  EXPECT_NEAR(four.lower, 4.0 * one.lower, 1e-12);
  EXPECT_NEAR(four.upper, 4.0 * one.upper, 1e-12);
  const Interval in_fours =
      RunMean::of_ratio(summary(30, 4.0, 3.2, 1.0)).in_units_of(4.0).interval(0.95);
  EXPECT_NEAR(in_fours.upper, one.upper, 1e-12);
}

TEST(RunMean, KnowsRunsThatDoNotDifferAndRunsThatAreFew) {
  EXPECT_EQ(RunMean::of_ratio(summary(30, 0.0, 0.0, 0.0)).p_value(1.0), 0.0);
  EXPECT_EQ(RunMean::of_ratio(summary(30, 1.0, 0.0, 0.0)).p_value(1.0), 1.0);
  EXPECT_EQ(RunMean::of_symmetric(summary(30, 0.5, 0.0, 0.0)).p_value(0.0), 0.0);
  EXPECT_EQ(RunMean::of_ratio(summary(2, 9.0, 1.0, kNaN)).p_value(1.0), 1.0);
  EXPECT_TRUE(std::isnan(RunMean::of_ratio(summary(2, 9.0, 1.0, kNaN)).interval(0.95).lower));
  // A sample on the side of the short tail says nothing of the long one, but that it is far below.
  const RunMean tiny = RunMean::of_ratio(summary(30, 3e-4, 1e-4, 4.0));
  EXPECT_LT(tiny.p_value(1.0), 1e-9);
  EXPECT_LT(tiny.interval(0.999).upper, 0.01);
  EXPECT_EQ(RunMean::of_product(summary(30, 1e-12, 1e-14, 0.0)).p_value(0.0), 1.0) << "rounding";
}

}  // namespace
}  // namespace montecarta::analysis
