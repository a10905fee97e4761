// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/bootstrap.hpp"

#include "engine/random/stream.hpp"

#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <gtest/gtest.h>

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

/// Share of 400 studies whose interval holds the truth.
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
TEST(Bootstrap, HoldsTheMeanAsOftenAsItSays) {
  EXPECT_NEAR(coverage(normals, 20, 5.0), 0.95, 0.04);
  EXPECT_NEAR(coverage(normals, 60, 5.0), 0.95, 0.04);
}

// The plain percentile interval holds the mean of 20 exponentials in 90 % of studies.
TEST(Bootstrap, MakesUpForSkewness) { EXPECT_NEAR(coverage(exponentials, 20, 1.0), 0.945, 0.03); }

TEST(Bootstrap, IsNearStudentsIntervalOfManyNormals) {
  const std::vector<double> values = normals(1, 400);
  double mean = 0.0, squares = 0.0;
  for (const double value : values) mean += value / 400.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  const double half = 1.966 * std::sqrt(squares / 399.0 / 400.0);
  const Interval interval = bootstrap_mean(values, 0.95);
  EXPECT_NEAR(interval.lower, mean - half, 0.08 * half);
  EXPECT_NEAR(interval.upper, mean + half, 0.08 * half);
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

TEST(Bootstrap, OfEqualValuesIsThatValue) {
  const Interval interval = bootstrap_mean(std::vector<double>(10, 3.0), 0.95);
  EXPECT_DOUBLE_EQ(interval.lower, 3.0);
  EXPECT_DOUBLE_EQ(interval.upper, 3.0);
}

}  // namespace
}  // namespace montecarta::analysis
