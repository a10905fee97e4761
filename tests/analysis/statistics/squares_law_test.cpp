// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/squares_law.hpp"

#include "analysis/verdict/verdict.hpp"
#include "analysis/verdict/whole_error.hpp"
#include "engine/random/stream.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/special_functions/erf.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <vector>

namespace montecarta::analysis {
namespace {

const boost::math::chi_squared& chi_squared(double freedom) {
  static std::map<double, boost::math::chi_squared> known;
  return known.try_emplace(freedom, freedom).first->second;
}

TEST(SquaresLaw, IsTheChiSquareOfErrorsThatNeverChange) {
  const SquaresLaw law(traces_of_constant_errors(300.0, 30'000.0), 20.0);  // 100 scans
  for (const double score : {-3.0, -1.0, 0.5, 2.0}) {
    const double p = 0.5 * std::erfc(-score / std::sqrt(2.0));
    EXPECT_NEAR(law.quantile(score), boost::math::quantile(chi_squared(60.0), p) / 60.0, 1e-9);
  }
  EXPECT_NEAR(law.p_value(1.3), 2.0 * cdf(complement(chi_squared(60.0), 78.0)), 1e-9);
}

TEST(SquaresLaw, IsTheChiSquareOfIndependentErrors) {
  const SquaresLaw law({300.0, 300.0, 300.0}, 20.0);
  EXPECT_NEAR(law.p_value(0.96), 2.0 * cdf(chi_squared(6000.0), 5760.0), 1e-9);
}

// z = 2 x^2 + y^2 of a variance 4 and of one of its own: kappa_1 = 5, t_2 = 17, t_3 = 65.
TEST(SquaresLaw, HasTheCumulantsThatTheTracesGive) {
  const SquaresLaw law({5.0, 17.0, 65.0}, 1.0);
  double mean = 0.0, second = 0.0, third = 0.0;
  constexpr int kSteps = 200'000;
  for (int i = 0; i < kSteps; ++i) {
    const double p = (i + 0.5) / kSteps;
    const double x = 5.0 * law.quantile(-std::sqrt(2.0) * boost::math::erfc_inv(2.0 * p));
    mean += x / kSteps;
    second += x * x / kSteps;
    third += x * x * x / kSteps;
  }
  EXPECT_NEAR(mean, 5.0, 0.01);
  EXPECT_NEAR(second - mean * mean, 34.0, 0.5);
  EXPECT_NEAR(third - 3.0 * mean * second + 2.0 * mean * mean * mean, 520.0, 25.0);
}

TEST(SquaresLaw, HoldsTheRatioInAnIntervalThatExcludesOneIfItRejects) {
  Traces traces = {300.0, 900.0, 4000.0};
  traces.freedom = 12.0;
  const SquaresLaw law(traces, 40.0);
  for (const double ratio : {0.8, 0.95, 1.02, 1.2, 1.5}) {
    for (const double level : {0.9, 0.99}) {
      const Interval interval = law.interval(ratio, level);
      EXPECT_LT(interval.lower, ratio);
      EXPECT_GT(interval.upper, ratio);
      const bool excludes = interval.lower > 1.0 || interval.upper < 1.0;
      EXPECT_EQ(excludes, law.p_value(ratio) < 1.0 - level) << ratio << ' ' << level;
    }
  }
}

TEST(SquaresLaw, HasAnswersForWhatIsFarOff) {
  const SquaresLaw law(traces_of_constant_errors(300.0, 30'000.0), 200.0);
  EXPECT_LT(law.p_value(1e60), 1e-200);
  EXPECT_LT(law.p_value(0.0), 1e-200);
  EXPECT_GT(law.interval(1e60, 0.95).lower, 1e59);
  EXPECT_TRUE(std::isfinite(law.interval(1.0, 1.0).upper)) << "a level that rounding made 1";
}

RunProducts products_of(const std::vector<double>& rows, std::size_t runs) {
  RunProducts products(runs);
  products.add(rows, rows.size() / runs);
  return products;
}

TEST(RunProducts, AreTheScalarProducts) {
  const RunProducts products = products_of({1, 2, 3, 4, 5, 6, -1, 0, 2, 1, 1, 1, 0, 2, 0}, 5);
  EXPECT_EQ(products(0, 0), 14.0);
  EXPECT_EQ(products(0, 1), 32.0);
  EXPECT_EQ(products(1, 0), 32.0);
  EXPECT_EQ(products(2, 4), 0.0);
  EXPECT_EQ(products(4, 1), 10.0);
  EXPECT_EQ(products.squares_with_others(2), 25.0 + 64.0 + 1.0);
}

TEST(RunProducts, AddUpCyclesOfThreeRuns) {
  const RunProducts products = products_of({1, 2, -1, 3}, 4);  // G_ij = x_i x_j
  double cycles = 0.0;
  const std::vector<double> x = {1, 2, -1, 3};
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      for (std::size_t k = 0; k < 4; ++k) {
        if (i != j && j != k && k != i) cycles += x[i] * x[i] * x[j] * x[j] * x[k] * x[k];
      }
    }
  }
  EXPECT_EQ(products.cycles(), cycles);
}

TEST(TracesOf, KeepTheirOrderIfRunsHaveLessThanOneErrorOnAverage) {
  const Traces traces = traces_of(products_of({1, 2, -1, 3, 0.5, 1.5}, 6), 0.5, 0.5, 1.0);
  EXPECT_DOUBLE_EQ(traces.second, 0.5);
  EXPECT_DOUBLE_EQ(traces.third, 0.5);  // the second one squared, by the first one
}

TEST(MeanSquaredProduct, HasTheDeviationOfTheJackknife) {
  const RunProducts products = products_of({1, 2, -1, 3, 0.5, 1.5}, 6);
  const MeanSquaredProduct found = mean_squared_product(products);
  std::vector<double> without;
  for (std::size_t left_out = 0; left_out < 6; ++left_out) {
    double sum = 0.0;
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t j = 0; j < 6; ++j) {
        if (i != j && i != left_out && j != left_out) sum += products(i, j) * products(i, j);
      }
    }
    without.push_back(sum / 20.0);
  }
  const double mean = std::accumulate(without.begin(), without.end(), 0.0) / 6.0;
  double squares = 0.0;
  for (const double value : without) squares += (value - mean) * (value - mean);
  EXPECT_NEAR(found.mean, mean, 1e-12);
  EXPECT_NEAR(found.deviation, std::sqrt(5.0 / 6.0 * squares), 1e-12);
}

/// Errors of an autoregression, some of them missing.
ErrorsOfRuns autoregression(std::size_t runs, std::size_t scans, double correlation,
                            double missing) {
  ErrorsOfRuns errors(runs);
  for (std::uint64_t run = 0; run < runs; ++run) {
    RngStream draw({.seed = 7, .run = run, .purpose = Draw::test});
    double state = draw.normal();
    for (std::size_t s = 0; s < scans; ++s) {
      if (s > 0)
        state = correlation * state + std::sqrt(1 - correlation * correlation) * draw.normal();
      errors[run].push_back(draw.uniform() < missing ? kNaN : 3.0 * state);
    }
  }
  return errors;
}

// tr R^2 is sum_ij r^(2 |i - j|) for any scale of the errors, and whether or not some of them are
// missing.
TEST(Traces, AreThoseOfTheCorrelationMatrix) {
  constexpr std::size_t kScans = 60;
  double second = 0.0;
  for (int i = 0; i < static_cast<int>(kScans); ++i) {
    for (int j = 0; j < static_cast<int>(kScans); ++j) second += std::pow(0.8, 2 * std::abs(i - j));
  }
  for (const double missing : {0.0, 0.1}) {
    const ErrorsOfRuns rows = autoregression(256, kScans, 0.8, missing);
    const DividedErrors errors(rows, kScans, 1);
    const Traces found = errors.products({0, kScans, 0, 1}).traces();
    EXPECT_NEAR(found.first, kScans * (1.0 - missing), missing > 0.0 ? 0.5 : 1e-12);
    const double q = 1.0 - missing;  // a run has both of two errors with the probability q^2
    const double expected = q * q * (second - kScans) + q * kScans;
    EXPECT_GT(found.second, 0.97 * expected) << missing;
    EXPECT_LT(found.second, 1.15 * expected) << missing << ", by a standard error and by q";
  }
}

// Three components of which one is known exactly: errors that never change have 2 T eigenvalues.
TEST(Traces, AreBoundedByTheComponentsThatAreOpen) {
  ErrorsOfRuns errors(30);
  for (std::uint64_t run = 0; run < errors.size(); ++run) {
    RngStream draw({.seed = 9, .run = run, .purpose = Draw::test});
    const double one = draw.normal(), other = draw.normal();
    for (int s = 0; s < 10; ++s) errors[run].insert(errors[run].end(), {one, other, kNaN});
  }
  const AspectProducts found = DividedErrors(errors, 10, 3).products({0, 10, 0, 3});
  EXPECT_EQ(found.terms(), 20.0);
  EXPECT_NEAR(found.traces().second, 200.0, 1e-9);
}

TEST(Traces, OfFewRunsAreThoseOfConstantErrors) {
  const ErrorsOfRuns rows = autoregression(19, 60, 0.0, 0.0);
  const DividedErrors errors(rows, 60, 1);
  const Traces found = errors.products({0, 60, 0, 1}).traces();
  EXPECT_EQ(found.second, 3600.0);
  EXPECT_TRUE(std::isinf(found.freedom));
}

TEST(Spending, ResemblesTheBoundariesOfOBrienAndFleming) {
  EXPECT_NEAR(spent(0.05, 1.0), 0.05, 1e-12);
  EXPECT_NEAR(spent(0.05, 0.5), 0.00557, 1e-5);  // Lan and DeMets 1983
  EXPECT_NEAR(spent(0.05, 0.2), 1.17e-5, 1e-7);
  EXPECT_EQ(spent(0.05, 0.0), 0.0);
}

TEST(LevelOfLook, SpendsTheErrorProbabilityOnce) {
  const std::vector<std::uint64_t> looks = {32, 64, 128, 200};
  double all = 0.0;
  for (const std::uint64_t look : looks) all += 1.0 - level_of_look(0.95, looks, look);
  EXPECT_NEAR(all, 0.05, 1e-8);
  EXPECT_LT(level_of_look(0.95, looks, 32), 1.0);
  EXPECT_EQ(level_of_look(0.95, looks, 100), level_of_look(0.95, looks, 128));
  EXPECT_EQ(level_of_look(0.95, looks, 500), level_of_look(0.95, looks, 200));
  EXPECT_EQ(level_of_look(0.95, {}, 100), 0.95);
  EXPECT_EQ(level_of_look(0.95, std::vector<std::uint64_t>{20}, 20), 0.95);
}

}  // namespace
}  // namespace montecarta::analysis
