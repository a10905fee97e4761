// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/sampler_scale.hpp"

#include "analysis/metrics/nees.hpp"
#include "analysis/statistics/uniformity.hpp"
#include "engine/random/stream.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace montecarta::analysis {
namespace {

/// NEES by the spread, with 1 / M, of M draws, of a truth drawn from the same normal.
double ideal_nees(std::size_t particles, RngStream& draw) {
  const auto point = [&] { return Eigen::Vector3d(draw.normal(), draw.normal(), draw.normal()); };
  std::vector<Eigen::Vector3d> cloud(particles);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (Eigen::Vector3d& particle : cloud) mean += particle = point();
  mean /= static_cast<double>(particles);
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& particle : cloud) {
    spread += (particle - mean) * (particle - mean).transpose();
  }
  return nees<3>(point() - mean, spread / static_cast<double>(particles)).value;
}

/// `particles` of equal weight.
EffectiveDraws equal(double particles) { return {particles, particles}; }

// 20,000 draws: a share has a standard error of at most 0.0036.
TEST(SamplerScale, MakesTheNeesOfIdealSamplersChiSquare) {
  const SamplerScale scale(3);
  for (const std::size_t particles : {6u, 10u, 100u}) {
    const EffectiveDraws draws = equal(static_cast<double>(particles));
    RngStream draw({41, particles, 0, 0, Draw::test});
    std::vector<double> found;
    for (int k = 0; k < 20'000; ++k) found.push_back(scale(ideal_nees(particles, draw), draws));
    for (const double p : {0.025, 0.5, 0.975, 0.999}) {
      const double quantile = boost::math::quantile(boost::math::chi_squared(3), p);
      const auto below = std::ranges::count_if(found, [&](double v) { return v < quantile; });
      EXPECT_NEAR(static_cast<double>(below) / 20'000.0, p,
                  5.0 * std::sqrt(p * (1.0 - p) / 20'000.0))
          << particles << " particles";
    }
  }
}

/// What is as probable under the chi-square as `nees` under Hotelling's F, without a table.
double exactly(double nees, double d, double M) {
  const boost::math::fisher_f ideal(d, M - d);
  const double above =
      boost::math::cdf(boost::math::complement(ideal, nees * (M - d) / (d * (M + 1.0))));
  return boost::math::quantile(boost::math::complement(boost::math::chi_squared(d), above));
}

TEST(SamplerScale, IsRightToAThousandthBetweenItsEntries) {
  for (const std::size_t dimension : {1u, 2u, 3u}) {
    const SamplerScale scale(dimension);
    const auto d = static_cast<double>(dimension);
    for (const double M : {d + 2.013, d + 3.7, 10.0, 29.3, 71.0, 555.5}) {
      for (double nees = 0.01; exactly(nees, d, M) < 20.0; nees *= 1.037) {
        EXPECT_NEAR(scale(nees, equal(M)) / exactly(nees, d, M), 1.0, 1e-3) << nees << " of " << M;
      }
    }
  }
}

TEST(SamplerScale, GrowsInProportionWhereNoIdealSamplerIs) {
  const SamplerScale scale(3);
  for (const double M : {5.1, 10.0, 100.0}) {
    const double far = scale(1e9, equal(M));
    EXPECT_NEAR(scale(1e12, equal(M)) / far, 1e3, 1e-6) << M;
    EXPECT_LT(far, 1e9);
  }
  EXPECT_GT(scale(1e5, equal(100.0)), 7e4);
  EXPECT_GT(scale(1e5, equal(30.0)), 4e4);
}

TEST(SamplerScale, GrowsWithTheNeesAndStaysFinite) {
  const SamplerScale scale(2);
  double before = 0.0;
  for (double nees = 1e-7; nees < 1e14; nees *= 1.5) {
    EXPECT_GT(scale(nees, equal(5.0)), before) << nees;
    before = scale(nees, equal(5.0));
  }
  EXPECT_EQ(scale(0.0, equal(5.0)), 0.0);
  EXPECT_TRUE(std::isnan(scale(std::nan(""), equal(5.0))));
  EXPECT_TRUE(std::isfinite(scale(1e300, equal(5.0))));
}

TEST(SamplerScale, JudgesMoreThanTwoDrawsAboveTheComponents) {
  EXPECT_FALSE(SamplerScale(3).can_judge(equal(5.0)));
  EXPECT_TRUE(SamplerScale(3).can_judge(equal(5.01)));
  EXPECT_TRUE(SamplerScale(1).can_judge(equal(4.0)));
}

TEST(EffectiveDraws, AreAllOfEqualWeightAndBetweenThatAndTheirEffectiveSizeElse) {
  EXPECT_EQ(effective_draws(30, 30.0).of_variance, 30.0);
  EXPECT_EQ(effective_draws(30, 31.0).of_mean, 30.0);
  EXPECT_EQ(effective_draws(30, 1.0).of_variance, 1.0);
  for (double ess = 1.01; ess < 100.0; ess *= 1.1) {
    const EffectiveDraws draws = effective_draws(100, ess);
    EXPECT_EQ(draws.of_mean, ess);
    EXPECT_GE(draws.of_variance, ess * (1.0 - 1e-12));
    EXPECT_LE(draws.of_variance, 100.0);
  }
}

/// PIT values of a filter whose errors are `inflation` times what it says, and `bias` deviations
/// aside.
std::vector<double> pits(std::size_t n, double inflation, double bias, std::uint64_t study) {
  RngStream draw({.seed = 77, .run = study});
  const boost::math::normal standard;
  std::vector<double> values;
  for (std::size_t i = 0; i < n; ++i) {
    values.push_back(cdf(standard, bias + inflation * draw.normal()));
  }
  return values;
}

double alarms(std::size_t n, double inflation, double bias, Calibration verdict) {
  constexpr std::uint64_t kStudies = 2000;
  const CountBand band = band_for(n, 0.95);
  double found = 0.0;
  for (std::uint64_t study = 0; study < kStudies; ++study) {
    const auto values = pits(n, inflation, bias, study);
    if (judge_uniformity(values, band).verdict == verdict) found += 1.0 / kStudies;
  }
  return found;
}

// The band's own probability is exact, so that the rate of false alarms is known: 1 - joint, a
// little below 5 % since counts are whole. 2000 studies, 4 standard errors.
TEST(Uniformity, RaisesFalseAlarmsAtTheStatedLevel) {
  for (const std::size_t n : {60u, 200u}) {
    const double rate = 1.0 - band_for(n, 0.95).joint;
    EXPECT_LE(rate, 0.05);
    EXPECT_GT(rate, 0.025);
    EXPECT_NEAR(1.0 - alarms(n, 1.0, 0.0, Calibration::calibrated), rate,
                4.0 * std::sqrt(rate * (1.0 - rate) / 2000.0));
  }
}

TEST(Uniformity, NamesWhatIsWrong) {
  EXPECT_GT(alarms(200, 1.6, 0.0, Calibration::too_narrow), 0.95);
  EXPECT_GT(alarms(200, 0.6, 0.0, Calibration::too_wide), 0.95);
  EXPECT_GT(alarms(200, 1.0, 0.6, Calibration::shifted), 0.95);
}

// Two bins are one binomial: the band's probability by hand.
TEST(Uniformity, KnowsTheProbabilityOfItsBand) {
  const CountBand band = joint_band(4, 2, 0.5);
  EXPECT_EQ(band.lower, 1u);
  EXPECT_EQ(band.upper, 3u);
  EXPECT_NEAR(band.joint, 14.0 / 16.0, 1e-12);
}

TEST(Uniformity, SaysNothingOfAFew) {
  EXPECT_EQ(judge_uniformity(pits(kLeastValues - 1, 9.0, 0.0, 0), {}).verdict,
            Calibration::untested);
  EXPECT_EQ(judge_uniformity({}, {}).verdict, Calibration::untested);
}

}  // namespace
}  // namespace montecarta::analysis
