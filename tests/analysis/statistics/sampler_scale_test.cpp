// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/sampler_scale.hpp"

#include "analysis/run/nees.hpp"
#include "engine/random/stream.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
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
TEST(SamplerScale, SlowMakesTheNeesOfIdealSamplersChiSquare) {
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

/// (4.2) without a table: the chi-square value that is as probable as `nees` is under Hotelling's
/// F; beyond a tail of one in a million it is proportional.
double exactly(double nees, double d, double M) {
  constexpr double kLastTail = 1e-6;
  const boost::math::fisher_f ideal(d, M - d);
  const boost::math::chi_squared scale(d);
  const double f = nees * (M - d) / (d * (M + 1.0));
  const double last = boost::math::quantile(boost::math::complement(ideal, kLastTail));
  const double above = boost::math::cdf(boost::math::complement(ideal, std::min(f, last)));
  return boost::math::quantile(boost::math::complement(scale, above)) * std::max(1.0, f / last);
}

TEST(SamplerScale, IsRightToAThousandthBetweenItsEntriesAndBeyondThem) {
  for (const std::size_t dimension : {1u, 2u, 3u}) {
    const SamplerScale scale(dimension);
    const auto d = static_cast<double>(dimension);
    for (const double M : {d + 2.013, d + 3.7, 10.0, 29.3, 71.0, 555.5}) {
      for (double nees = 0.01; exactly(nees, d, M) < 100.0; nees *= 1.037) {
        EXPECT_NEAR(scale(nees, equal(M)) / exactly(nees, d, M), 1.0, 1e-3) << nees << " of " << M;
      }
    }
  }
}

// Against integrals by scipy.stats.f over 400,000 equally probable values.
TEST(SamplerScale, ShowsTheRatioOfFewDrawsTooNearToOne) {
  struct Known {
    double particles, ratio, shown;
  };
  const SamplerScale scale(3);
  for (const Known& known :
       {Known{6, 1, 1.0}, Known{1000, 1, 1.0}, Known{6, 2, 1.4355}, Known{10, 0.5, 0.5814},
        Known{10, 2, 1.6236}, Known{20, 2, 1.7893}, Known{100, 2, 1.9523}, Known{30, 4, 3.2892}}) {
    EXPECT_NEAR(scale.shown_ratio(known.ratio, equal(known.particles)) / known.shown, 1.0, 1e-3)
        << known.ratio << " of " << known.particles;
  }
}

// 20,000 draws; the tolerance is 4 standard errors.
TEST(SamplerScale, SlowShowsOfDrawnSamplersTheRatioThatItComputes) {
  const SamplerScale scale(3);
  constexpr double kRatio = 2.0, kDraws = 20'000.0;
  for (const std::size_t particles : {10u, 20u, 100u}) {
    const EffectiveDraws draws = equal(static_cast<double>(particles));
    RngStream draw({43, particles, 0, 0, Draw::test});
    double sum = 0.0, squares = 0.0;
    for (int k = 0; k < 20'000; ++k) {
      const double shown = scale(kRatio * ideal_nees(particles, draw), draws) / 3.0;
      sum += shown;
      squares += shown * shown;
    }
    const double mean = sum / kDraws;
    EXPECT_NEAR(mean, scale.shown_ratio(kRatio, draws),
                4.0 * std::sqrt((squares / kDraws - mean * mean) / kDraws))
        << particles << " particles";
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

}  // namespace
}  // namespace montecarta::analysis
