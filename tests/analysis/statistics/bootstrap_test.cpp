// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/bootstrap.hpp"

#include "analysis/statistics/distributions.hpp"
#include "analysis/statistics/paired_tests.hpp"
#include "analysis/statistics/spread.hpp"
#include "engine/random/stream.hpp"
#include "tests/doubles/matchers.hpp"

#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace montecarta::analysis {
namespace {

RngStream stream(std::uint64_t run) { return RngStream({7, run, 0, 0, Draw::test}); }

std::vector<double> normals(std::uint64_t run, std::size_t n) {
  RngStream draw = stream(run);
  std::vector<double> values(n);
  for (double& value : values) value = 5.0 + 2.0 * draw.normal();
  return values;
}

/// Skewed to the right, mean 1.
std::vector<double> exponentials(std::uint64_t run, std::size_t n) {
  RngStream draw = stream(run);
  std::vector<double> values(n);
  for (double& value : values) value = -std::log(draw.uniform());
  return values;
}

/// Share of 400 studies with an interval that holds the truth.
template <class Draw>
double coverage(const Draw& draw, std::size_t n, double truth) {
  constexpr std::uint64_t kStudies = 400;
  double held = 0.0;
  for (std::uint64_t study = 0; study < kStudies; ++study) {
    const Interval interval = bootstrap_mean(draw(study, n), 0.95);
    held += interval.lower <= truth && truth <= interval.upper ? 1.0 : 0.0;
  }
  return held / static_cast<double>(kStudies);
}

/// The BCa interval as Efron and Tibshirani (1993) have it, section 14.3, with the acceleration of
/// the jackknife, (14.15), and, as Hesterberg (2015) asks of few values, deviates of Student's t.
Interval by_the_book(const std::vector<double>& values, double level) {
  const auto n = static_cast<double>(values.size());
  const auto mean_without = [&](std::size_t left_out) {
    double sum = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) sum += i == left_out ? 0.0 : values[i];
    return sum / (n - 1.0);
  };
  double mean = 0.0, squares = 0.0, cubes = 0.0;
  for (const double value : values) mean += value / n;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double d = mean - mean_without(i);
    squares += d * d;
    cubes += d * d * d;
  }
  const double acceleration = cubes / (6.0 * std::pow(squares, 1.5));
  std::vector<double> means;
  std::vector<std::uint32_t> drawn;
  for (std::size_t b = 0; b < bootstrap_replicates(values.size()); ++b) {
    draw_runs(values.size(), b, drawn);
    double sum = 0.0;
    for (const std::uint32_t i : drawn) sum += values[i];
    means.push_back(sum / n);
  }
  std::ranges::sort(means);
  const boost::math::normal normal;
  const auto below =
      static_cast<double>(std::ranges::count_if(means, [&](double m) { return m < mean; }));
  const double z0 = boost::math::quantile(normal, below / static_cast<double>(means.size()));
  const double z = std::sqrt(n / (n - 1.0)) *
                   boost::math::quantile(boost::math::students_t(n - 1.0), 0.5 + 0.5 * level);
  const auto end = [&](double deviate) {
    const double shifted = z0 + deviate;
    const double share = boost::math::cdf(normal, z0 + shifted / (1.0 - acceleration * shifted));
    const double place = share * static_cast<double>(means.size()) - 0.5;  // midpoints of steps
    const auto low = static_cast<std::size_t>(place);
    return std::lerp(means[low], means[low + 1], place - std::floor(place));
  };
  return {end(-z), end(z)};
}

TEST(Bootstrap, IsTheAcceleratedIntervalOfTheBook) {
  for (const std::size_t n : {14u, 30u}) {  // so many that hardly a replicate ties with the mean
    const std::vector<double> values = exponentials(5, n);
    const Interval ours = bootstrap_mean(values, 0.9), book = by_the_book(values, 0.9);
    EXPECT_NEAR(ours.lower, book.lower, 1e-12) << n;
    EXPECT_NEAR(ours.upper, book.upper, 1e-12) << n;
  }
}

// Half of the replicates of (0, 1) equal the mean: half of them count as below, which is no bias.
TEST(Bootstrap, CountsTiesHalf) {
  const Interval interval = bootstrap_mean(std::vector<double>{0.0, 1.0, 0.0, 1.0}, 0.5);
  EXPECT_NEAR(0.5 * (interval.lower + interval.upper), 0.5, 0.02);
}

// 400 studies: one standard error is 0.011.
TEST(Bootstrap, SlowHoldsTheMeanAsOftenAsItSaysAndMakesUpForSkewness) {
  EXPECT_NEAR(coverage(normals, 20, 5.0), 0.95, 0.04);
  EXPECT_NEAR(coverage(normals, 60, 5.0), 0.95, 0.04);
  // The plain percentile interval holds the mean of 20 exponentials in 90 % of studies.
  EXPECT_NEAR(coverage(exponentials, 20, 1.0), 0.945, 0.03);
}

TEST(Bootstrap, GivesColumnsWhatEachWouldGetAlone) {
  const std::vector<std::vector<double>> columns = {normals(1, 30), exponentials(2, 30)};
  const std::vector<Interval> together = bootstrap_means(columns, 0.9);
  for (std::size_t c = 0; c < 2; ++c) {
    const Interval alone = bootstrap_mean(columns[c], 0.9);
    EXPECT_EQ(together[c].lower, alone.lower);
    EXPECT_EQ(together[c].upper, alone.upper);
  }
}

TEST(Bootstrap, SaysNothingOfTooLittle) {
  EXPECT_TRUE(std::isnan(bootstrap_mean(std::vector<double>{1.0}, 0.95).lower));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(bootstrap_mean(std::vector<double>{1.0, nan, 2.0}, 0.95).upper));
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(std::isnan(bootstrap_mean(std::vector<double>{1.0, infinite, 2.0}, 0.95).lower));
  const double most = std::numeric_limits<double>::max();
  EXPECT_TRUE(std::isnan(bootstrap_mean(std::vector<double>{most, 1.0, most}, 0.95).lower));
}

TEST(Bootstrap, OfManyRunsIsStudentsInterval) {
  std::vector<double> values = exponentials(1, 20'000);
  const Interval drawn = bootstrap_mean(values, 0.95);
  values.push_back(1.0);
  const Interval found = bootstrap_mean(values, 0.95);
  const Summary all = summary_of(values);
  const double half = t_score(0.95, static_cast<double>(all.n) - 1.0) * all.standard_error();
  EXPECT_DOUBLE_EQ(found.lower, all.mean - half);
  EXPECT_DOUBLE_EQ(found.upper, all.mean + half);
  EXPECT_NEAR(found.lower, drawn.lower, 0.15 * half);  // of 1000 replicates
  EXPECT_NEAR(found.upper, drawn.upper, 0.15 * half);
  values.front() = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(std::isnan(bootstrap_mean(values, 0.95).lower));
}

TEST(Bootstrap, OfEqualValuesIsThatValue) {
  const Interval interval = bootstrap_mean(std::vector<double>(10, 3.0), 0.95);
  EXPECT_DOUBLE_EQ(interval.lower, 3.0);
  EXPECT_DOUBLE_EQ(interval.upper, 3.0);
}

TEST(SignTest, IsThatOfAFairCoin) {
  EXPECT_DOUBLE_EQ(sign_test(3, 7), 0.34375);  // 2 (1 + 10 + 45 + 120) / 1024
  EXPECT_DOUBLE_EQ(sign_test(7, 3), 0.34375);
  EXPECT_DOUBLE_EQ(sign_test(0, 20), std::ldexp(1.0, -19));
  EXPECT_NEAR(sign_test(450, 550), 0.0017305360849763024, 1e-15);  // SciPy's binomtest
  EXPECT_DOUBLE_EQ(sign_test(500, 501), 1.0);
  EXPECT_DOUBLE_EQ(sign_test(0, 0), 1.0);
}

// Darwin's maize in eighths of an inch, as Wilcoxon and Fisher discuss it: SciPy's wilcoxon.
TEST(SignedRankTest, IsExactOnDarwinsMaize) {
  const std::vector<double> maize = {6, 8, 14, 16, 23, 24, 28, 29, 41, -48, 49, 56, 60, -67, 75};
  const SignedRank test = signed_rank_test(maize);
  EXPECT_TRUE(test.is_exact);
  EXPECT_EQ(test.n, 15u);
  EXPECT_DOUBLE_EQ(test.negative, 24.0);
  EXPECT_DOUBLE_EQ(test.positive + test.negative, 120.0);
  EXPECT_DOUBLE_EQ(test.p, 0.041259765625);
}

TEST(SignedRankTest, SharesRanksOfTiesAndLeavesOutZeros) {
  const std::vector<double> pairs = {15, -7, 5, 20, 0, -9, 17, -12, 5, -10};
  const SignedRank test = signed_rank_test(pairs);
  EXPECT_FALSE(test.is_exact);
  EXPECT_EQ(test.n, 9u);
  EXPECT_DOUBLE_EQ(test.negative, 18.0);
  EXPECT_NEAR(test.p, 0.5936305914425295, 1e-14);
  EXPECT_DOUBLE_EQ(signed_rank_test({}).p, 1.0);
  EXPECT_DOUBLE_EQ(signed_rank_test(std::vector<double>{0.0, 0.0}).p, 1.0);
}

// Holm's procedure as every textbook works it: 0.01, 0.04, 0.03 and 0.005 times 3, 1, 2 and 4.
TEST(Holm, AdjustsATextbookFamily) {
  EXPECT_THAT(holm(std::vector<double>{0.01, 0.04, 0.03, 0.005}),
              ElementsAre(DoubleNear(0.03, 1e-15), DoubleNear(0.06, 1e-15), DoubleNear(0.06, 1e-15),
                          DoubleNear(0.02, 1e-15)));
  EXPECT_THAT(holm(std::vector<double>{0.6, 0.9}), ElementsAre(1.0, 1.0));
  EXPECT_THAT(holm(std::vector<double>{}), ElementsAre());
}

/// Share of 2000 studies of `runs` pairs without difference that `p_of` calls different at 5 %.
template <class P>
double false_calls(std::size_t runs, P p_of) {
  RngStream draw({.seed = 8, .purpose = Draw::test});
  std::size_t calls = 0;
  for (int study = 0; study < 2000; ++study) {
    std::vector<double> differences(runs);
    for (double& d : differences) d = draw.normal();
    calls += p_of(differences) < 0.05 ? 1u : 0u;
  }
  return static_cast<double>(calls) / 2000.0;
}

// At most 5 %, five standard errors allowed; and near it where the distribution is fine enough.
TEST(PairedTests, SlowKeepTheirLevel) {
  const double error = std::sqrt(0.05 * 0.95 / 2000.0);
  const auto rank = [](const std::vector<double>& d) { return signed_rank_test(d).p; };
  const auto sign = [](const std::vector<double>& d) {
    const auto won =
        static_cast<std::size_t>(std::ranges::count_if(d, [](double v) { return v < 0; }));
    return sign_test(won, d.size() - won);
  };
  for (const std::size_t runs : {20u, 50u, 51u, 200u}) {
    EXPECT_NEAR(false_calls(runs, rank), 0.05, 5.0 * error) << runs;
    EXPECT_LT(false_calls(runs, sign), 0.05 + 5.0 * error) << runs;
  }
}

// Among ten values the second and the ninth hold the median with 97.9 %, the third and eighth with
// 89 %.
TEST(MedianInterval, LiesBetweenOrderStatistics) {
  const std::vector<double> sorted = {1, 2, 3, 4, 5, 6, 7, 8, 9, 1e9};
  EXPECT_EQ(median_interval(sorted, 0.95).lower, 2.0);
  EXPECT_EQ(median_interval(sorted, 0.95).upper, 9.0);
  EXPECT_EQ(median_interval(sorted, 0.9).lower, 2.0);
  EXPECT_EQ(median_interval(sorted, 0.89).lower, 3.0);
  EXPECT_TRUE(std::isnan(median_interval({1, 2, 3, 4, 5}, 0.95).lower));
}

}  // namespace
}  // namespace montecarta::analysis
