// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/bootstrap.hpp"

#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace montecarta {
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
}

TEST(Bootstrap, OfEqualValuesIsThatValue) {
  const Interval interval = bootstrap_mean(std::vector<double>(10, 3.0), 0.95);
  EXPECT_DOUBLE_EQ(interval.lower, 3.0);
  EXPECT_DOUBLE_EQ(interval.upper, 3.0);
}

}  // namespace
}  // namespace montecarta
