// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/uniformity.hpp"

#include "engine/random/stream.hpp"

#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/normal.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

namespace montecarta::analysis {
namespace {

/// PIT values of a filter with errors of `inflation` times the reported deviations and a bias.
std::vector<double> pits(std::size_t n, double inflation, double bias, std::uint64_t study) {
  RngStream draw({.seed = 77, .run = study});
  const boost::math::normal standard;
  std::vector<double> values;
  for (std::size_t i = 0; i < n; ++i) {
    values.push_back(cdf(standard, bias + inflation * draw.normal()));
  }
  return values;
}

constexpr std::uint64_t kUniformStudies = 2000;

/// Share of studies with this verdict.
double share_of(Calibration verdict, std::size_t n, double inflation, double bias) {
  const EcdfBand band = ecdf_band(n, 0.95);
  double found = 0.0;
  for (std::uint64_t study = 0; study < kUniformStudies; ++study) {
    const auto values = pits(n, inflation, bias, study);
    if (judge_uniformity(values, band, PitOf::error).verdict == verdict)
      found += 1.0 / kUniformStudies;
  }
  return found;
}

// The joint probability of the band is exact. 2000 studies, 4 standard errors.
TEST(Uniformity, SlowRaisesFalseAlarmsAtTheStatedLevel) {
  for (const std::size_t n : {20u, 100u, 1000u}) {
    const double rate = 1.0 - ecdf_band(n, 0.95).joint;
    EXPECT_LE(rate, 0.05);
    EXPECT_GT(rate, 0.045) << "the band is no wider than whole counts make it";
    EXPECT_NEAR(1.0 - share_of(Calibration::calibrated, n, 1.0, 0.0), rate,
                4.0 * std::sqrt(rate * (1.0 - rate) / kUniformStudies));
  }
}

// A p-value of 10 % or less is as rare as that, or a little rarer because counts are whole. 2000
// studies, 4 standard errors.
TEST(Uniformity, SlowHasPValuesThatAreUniform) {
  const EcdfBand band = ecdf_band(100, 0.95);
  std::map<double, double> shares = {{0.02, 0.0}, {0.1, 0.0}, {0.5, 0.0}};
  for (std::uint64_t study = 0; study < kUniformStudies; ++study) {
    const auto values = pits(100, 1.0, 0.0, study);
    const Uniformity found = judge_uniformity(values, band, PitOf::error);
    const double p_here = p_value(found);
    for (auto& [p, share] : shares) share += p_here <= p ? 1.0 / kUniformStudies : 0.0;
    EXPECT_EQ(p_here <= 1.0 - band.joint, found.verdict != Calibration::calibrated);
  }
  for (const auto& [p, share] : shares) {
    EXPECT_NEAR(share, p, 4.0 * std::sqrt(p * (1.0 - p) / kUniformStudies));
  }
}

TEST(Uniformity, SlowNamesTheFaultOfErrors) {
  EXPECT_GT(share_of(Calibration::too_narrow, 200, 1.6, 0.0), 0.95);
  EXPECT_GT(share_of(Calibration::too_wide, 200, 0.6, 0.0), 0.95);
  EXPECT_GT(share_of(Calibration::shifted, 200, 1.0, 0.6), 0.95);
  EXPECT_GT(share_of(Calibration::shifted, 200, 1.0, -5.0), 0.95);
  EXPECT_GT(share_of(Calibration::too_narrow, 20, 4.0, 0.0), 0.95) << "20 values are enough";
}

/// The verdict on 200 values with these quantiles at (i + 1/2) / 200.
template <class Quantile>
Calibration verdict_on_nees(const Quantile& quantile) {
  std::vector<double> values;
  for (int i = 0; i < 200; ++i) values.push_back(quantile((i + 0.5) / 200.0));
  return judge_uniformity(values, ecdf_band(200, 0.95), PitOf::squared_error).verdict;
}

TEST(Uniformity, NamesTheFaultOfANees) {
  EXPECT_EQ(verdict_on_nees([](double u) { return u; }), Calibration::calibrated);
  EXPECT_EQ(verdict_on_nees([](double u) { return std::sqrt(u); }), Calibration::too_narrow);
  EXPECT_EQ(verdict_on_nees([](double) { return 1.0; }), Calibration::too_narrow);
  EXPECT_EQ(verdict_on_nees([](double u) { return u * u; }), Calibration::too_wide);
  EXPECT_EQ(verdict_on_nees([](double) { return 0.0; }), Calibration::too_wide);
  EXPECT_EQ(verdict_on_nees([](double u) { return u < 0.5 ? 0.5 * u : 0.5 + 0.5 * u; }),
            Calibration::wrong_shape);
}

// One value leaves the band in the lowest and the highest steps that hold 2.5 % each at most.
TEST(Uniformity, KnowsTheBandOfOneValue) {
  const EcdfBand band = ecdf_band(1, 0.95);
  EXPECT_NEAR(band.joint, 0.96, 1e-12);
  EXPECT_EQ(band.upper(2), 0u);
  EXPECT_EQ(band.upper(3), 1u);
  EXPECT_EQ(band.lower[97], 0u);
  EXPECT_EQ(band.lower[98], 1u);
}

// 10^4 runs: the ends of the band are quantiles of binomial counts, all with the same tails.
TEST(Uniformity, HasTheSameTailsAtAllPointsOfManyValues) {
  const EcdfBand band = ecdf_band(10'000, 0.95);
  EXPECT_NEAR(band.joint, 0.95, 1e-3);
  std::vector<double> tails;
  for (std::size_t j = 10; j <= 90; ++j) {
    const boost::math::binomial law(10'000.0, static_cast<double>(j) / kEcdfSteps);
    tails.push_back(cdf(law, static_cast<double>(band.lower[j]) - 0.5));
  }
  const auto [least, greatest] = std::ranges::minmax(tails);
  EXPECT_LT(greatest / least, 1.3) << "whole counts";
}

TEST(Uniformity, MeasuresTheLargestDeviation) {
  const std::vector<double> values(50, 0.3);
  const Uniformity found = judge_uniformity(values, ecdf_band(50, 0.95), PitOf::error);
  EXPECT_NEAR(found.deviation, 0.7, 1e-12) << "a value at a point counts there";
  EXPECT_NEAR(found.mean, 0.3, 1e-12);
  EXPECT_NEAR(found.variance, 0.0, 1e-12);
  EXPECT_LT(p_value(found), 1e-10);
}

TEST(Uniformity, SaysNothingOfAFew) {
  for (const std::size_t n : {std::size_t{0}, kLeastValues - 1}) {
    const Uniformity found =
        judge_uniformity(pits(n, 9.0, 0.0, 0), ecdf_band(n, 0.95), PitOf::error);
    EXPECT_EQ(found.verdict, Calibration::untested);
    EXPECT_TRUE(std::isnan(p_value(found)));
  }
}

}  // namespace
}  // namespace montecarta::analysis
