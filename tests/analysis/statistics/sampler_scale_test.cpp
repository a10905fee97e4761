// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/sampler_scale.hpp"

#include "analysis/metrics/nees.hpp"
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

// 20,000 draws: a share has a standard error of at most 0.0036.
TEST(SamplerScale, MakesTheNeesOfIdealSamplersChiSquare) {
  for (const std::size_t particles : {6u, 10u, 100u}) {
    const SamplerScale scale(3, particles);
    RngStream draw({41, particles, 0, 0, Draw::test});
    std::vector<double> found;
    for (int k = 0; k < 20'000; ++k) found.push_back(scale(ideal_nees(particles, draw)));
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

TEST(SamplerScale, IsRightToTwoPartsInTenThousandBetweenItsEntries) {
  for (const std::size_t dimension : {1u, 2u, 3u}) {
    for (const std::size_t particles : {5u, 30u}) {
      const SamplerScale scale(dimension, particles);
      for (double nees = 0.01; nees < 1e3; nees *= 1.037) {
        const double exact =
            exactly(nees, static_cast<double>(dimension), static_cast<double>(particles));
        EXPECT_NEAR(scale(nees) / exact, 1.0, 2e-4) << nees << " of " << particles;
      }
    }
  }
}

TEST(SamplerScale, HardlyMovesTheNeesOfManyParticles) {
  const SamplerScale scale(3, 1'000'000);
  for (const double nees : {1e-3, 0.7, 3.0, 20.0}) EXPECT_NEAR(scale(nees), nees, 2e-4 * nees);
}

TEST(SamplerScale, GrowsWithTheNeesAndStaysFinite) {
  const SamplerScale scale(2, 5);
  double before = 0.0;
  for (double nees = 1e-5; nees < 1e14; nees *= 3.0) {
    EXPECT_GT(scale(nees), before) << nees;
    before = scale(nees);
  }
  EXPECT_EQ(scale(0.0), 0.0);
  EXPECT_TRUE(std::isnan(scale(std::nan(""))));
  EXPECT_TRUE(std::isfinite(scale(1e300)));
}

}  // namespace
}  // namespace montecarta::analysis
