// SPDX-License-Identifier: BSD-3-Clause
// Intervals of means that are shown are to be right, also of the values that diverging filters
// have; where none can be, the study says so.
#include "analysis/statistics/bootstrap.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/study/cell_sums.hpp"
#include "engine/random/stream.hpp"
#include "tests/analysis/verdict_studies.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace montecarta::analysis {
namespace {

constexpr std::uint64_t kTailStudies = 2000;

/// exp(sigma times a normal); its mean is exp(sigma^2 / 2), its median 1.
std::vector<double> log_normals(std::uint64_t study, std::size_t n, double sigma) {
  RngStream draw({8, study, 0, 0, Draw::test});
  std::vector<double> values(n);
  for (double& value : values) value = std::exp(sigma * draw.normal());
  return values;
}

std::vector<double> chi_squares(std::uint64_t study, std::size_t n) {
  RngStream draw({9, study, 0, 0, Draw::test});
  std::vector<double> values(n);
  for (double& value : values) {
    for (int c = 0; c < 3; ++c) value += std::pow(draw.normal(), 2);
  }
  return values;
}

/// Shares of studies.
struct Coverage {
  double flagged = 0.0;  ///< said to have a heavy tail
  double missed = 0.0;   ///< not said, and the interval does not hold the mean
};

template <class Sample>
Coverage coverage_of(std::uint64_t studies, const Sample& sample, double truth,
                     const std::string& name) {
  const double one = 1.0 / static_cast<double>(studies);
  Coverage found;
  for (std::uint64_t study = 0; study < studies; ++study) {
    const std::vector<double> values = sample(study);
    const bool heavy = is_heavy_tailed(values);
    found.flagged += heavy ? one : 0.0;
    if (heavy) continue;
    const Interval interval = bootstrap_mean(values, 0.95);
    found.missed += interval.lower <= truth && truth <= interval.upper ? 0.0 : one;
  }
  testing::Test::RecordProperty(name + "_flagged", std::to_string(found.flagged));
  testing::Test::RecordProperty(name + "_missed", std::to_string(found.missed));
  return found;
}

class SlowHeavyTail : public testing::TestWithParam<std::size_t> {
 protected:
  std::uint64_t studies_ = studies_of_a_line(GetParam() < 100 ? 1000 : 500);
};

TEST_P(SlowHeavyTail, IsSaidWhereIntervalsOfLogNormalMeansWouldNotHold) {
  for (const double sigma : {0.5, 1.0, 1.5, 2.5}) {
    const auto sample = [&](std::uint64_t study) { return log_normals(study, GetParam(), sigma); };
    const Coverage found = coverage_of(studies_, sample, std::exp(0.5 * sigma * sigma),
                                       "log_normal_" + std::to_string(sigma));
    EXPECT_LT(found.missed, 0.07 + share_errors(0.07, studies_)) << sigma;
    EXPECT_GT(found.flagged, sigma >= 1.5 ? 0.9 : 0.0) << sigma;
  }
}

TEST_P(SlowHeavyTail, IsHardlyEverSaidOfAConsistentFilter) {
  const auto sample = [&](std::uint64_t study) { return chi_squares(study, GetParam()); };
  const Coverage found = coverage_of(studies_, sample, 3.0, "chi_square");
  EXPECT_LT(found.missed, 0.05 + share_errors(0.05, studies_));
  EXPECT_LT(found.flagged, GetParam() < 100 ? 0.4 : 0.05);
}

INSTANTIATE_TEST_SUITE_P(OfRuns, SlowHeavyTail, testing::Values(20u, 40u, 200u));

TEST(SlowHeavyTailMedian, HasAnIntervalThatHolds) {
  for (const std::size_t n : {20u, 40u, 200u}) {
    double held = 0.0;
    for (std::uint64_t study = 0; study < kTailStudies; ++study) {
      std::vector<double> values = log_normals(study, n, 2.5);
      std::ranges::sort(values);
      const Interval interval = median_interval(values, 0.95);
      held += interval.lower <= 1.0 && 1.0 <= interval.upper ? 1.0 / kTailStudies : 0.0;
    }
    EXPECT_NEAR(held, 0.955, 0.025) << n;
  }
}

/// Expects intervals of the median of n values that hold it at least as often as they say, less
/// four standard errors, and none where all n values together would hold it too rarely.
template <class Sample>
void expect_median_intervals(const Sample& sample, double median) {
  for (std::size_t n = 0; n <= 12; ++n) {
    for (const double level : {0.6, 0.9, 0.95, 0.99, 0.999}) {
      const bool has_interval = 1.0 - std::exp2(1.0 - static_cast<double>(n)) >= level;
      double held = 0.0;
      for (std::uint64_t study = 0; study < kTailStudies; ++study) {
        std::vector<double> values = sample(study, n);
        std::ranges::sort(values);
        const auto [lower, upper] = median_interval(values, level);
        ASSERT_EQ(std::isnan(lower), !has_interval) << n << " values at " << level;
        ASSERT_EQ(std::isnan(upper), !has_interval) << n << " values at " << level;
        held += lower <= median && median <= upper ? 1.0 / kTailStudies : 0.0;
      }
      const double error = std::sqrt(level * (1.0 - level) / kTailStudies);
      EXPECT_GT(held, has_interval ? level - 4.0 * error : -1.0) << n << " values at " << level;
    }
  }
}

TEST(MedianInterval, OfFewValuesHoldsTheMedianOrIsAbsent) {
  expect_median_intervals([](auto study, auto n) { return log_normals(study, n, 1.5); }, 1.0);
  const double median = boost::math::median(boost::math::chi_squared(3.0));
  expect_median_intervals([](auto study, auto n) { return chi_squares(study, n); }, median);
}

constexpr std::uint64_t kStoppedStudies = 2000;

/// Average mean of studies that run until `enough`, divided by the true mean.
template <class Enough>
double ratio_of_stopped(double sigma, const Enough& enough) {
  double sum = 0.0;
  for (std::uint64_t study = 0; study < kStoppedStudies; ++study) {
    const std::vector<double> all = log_normals(study, 2048, sigma);
    std::vector<double> values;
    for (std::size_t n = 32; n <= all.size(); n *= 2) {
      values.assign(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(n));
      if (enough(values)) break;
    }
    sum += spread_of(values).summary.mean / kStoppedStudies;
  }
  return sum / std::exp(0.5 * sigma * sigma);
}

TEST(SlowUntil, IsNotStoppedByALuckySampleOfAHeavyTail) {
  const double wanted = 0.4 * std::exp(0.5 * 1.5 * 1.5);
  const double before =
      ratio_of_stopped(1.5, [&](const auto& v) { return summary_of(v).half_width(0.95) < wanted; });
  const double now =
      ratio_of_stopped(1.5, [&](const auto& v) { return is_precise(v, 0.95, wanted); });
  EXPECT_LT(before, 0.92);
  EXPECT_NEAR(now, 1.0, 0.02);
  testing::Test::RecordProperty("before", std::to_string(before));
  testing::Test::RecordProperty("now", std::to_string(now));
}

TEST(HeavyTail, IsOfOneValueThatDecidesTheMeanOfADistribution) {
  std::vector<double> values = chi_squares(1, 200);
  EXPECT_FALSE(is_heavy_tailed(values));
  EXPECT_FALSE(is_precise(values, 0.95, 0.01));
  EXPECT_TRUE(is_precise(values, 0.95, 1.0));
  values.back() = 1e5;
  EXPECT_TRUE(is_heavy_tailed(values));
  EXPECT_FALSE(is_precise(values, 0.95, 1e6));
  EXPECT_FALSE(is_precise({1.0}, 0.95, 1e6)) << "one value says nothing of the spread";
  EXPECT_FALSE(is_heavy_tailed(std::vector<double>{}));
  EXPECT_FALSE(is_heavy_tailed(std::vector<double>{1.0, 9.0}));
  EXPECT_FALSE(is_heavy_tailed(std::vector<double>(30, 2.0)));
  std::vector<double> shares(100, 0.0);
  std::fill_n(shares.begin(), 20, 1.0);
  EXPECT_FALSE(is_heavy_tailed(shares));
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(is_heavy_tailed(std::vector<double>{1.0, infinite, 2.0, 3.0}));
}

}  // namespace
}  // namespace montecarta::analysis
