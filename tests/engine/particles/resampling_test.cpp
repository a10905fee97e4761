// SPDX-License-Identifier: BSD-3-Clause
#include "engine/particles/resampling.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace montecarta::engine {
namespace {

StepContext step(std::uint32_t k) { return {11, 0, k, Parallel::serial()}; }

std::vector<double> random_weights(std::uint32_t seed, std::size_t n) {
  RngStream draw({seed, 0, 0, 0, Draw::test});
  std::vector<double> weights(n);
  double sum = 0.0;
  for (double& w : weights) sum += (w = -std::log(draw.uniform()));
  for (double& w : weights) w /= sum;
  return weights;
}

std::vector<int> children(Resampling scheme, const std::vector<double>& weights, std::uint32_t k) {
  std::vector<std::uint32_t> parents(weights.size());
  draw_parents(scheme, weights, step(k), parents);
  std::vector<int> counts(weights.size(), 0);
  for (std::uint32_t parent : parents) ++counts.at(parent);
  return counts;
}

class Schemes : public testing::TestWithParam<Resampling> {};

TEST_P(Schemes, GiveEachParticleItsShareOnAverage) {
  const auto weights = random_weights(1, 10);
  std::vector<double> mean(10, 0.0);
  const int rounds = 20000;
  for (std::uint32_t k = 0; k < rounds; ++k) {
    const auto counts = children(GetParam(), weights, k);
    for (std::size_t j = 0; j < 10; ++j) mean[j] += counts[j] / static_cast<double>(rounds);
  }
  for (std::size_t j = 0; j < 10; ++j) {  // no scheme varies more than the multinomial one
    const double share = 10 * weights[j];
    EXPECT_NEAR(mean[j], share, 5 * std::sqrt(share * (1 - weights[j]) / rounds))
        << "particle " << j;
  }
}

TEST_P(Schemes, NeverChooseAParticleWithoutWeight) {
  std::vector<double> weights(16, 0.0);
  weights[3] = 0.25, weights[4] = 0.75;
  for (std::uint32_t k = 0; k < 200; ++k) {
    const auto counts = children(GetParam(), weights, k);
    EXPECT_EQ(counts[3] + counts[4], 16);
  }
}

TEST_P(Schemes, SurviveWeightsThatSumToAlmostOne) {
  std::vector<double> weights(3, (1.0 - 1e-12) / 3.0);
  for (std::uint32_t k = 0; k < 200; ++k) {
    const auto counts = children(GetParam(), weights, k);
    EXPECT_EQ(counts[0] + counts[1] + counts[2], 3);
  }
}

INSTANTIATE_TEST_SUITE_P(All, Schemes,
                         testing::Values(Resampling::systematic, Resampling::stratified,
                                         Resampling::residual, Resampling::multinomial));

TEST(Resampling, SystematicKeepsFloorOrCeilingOfItsShare) {
  for (std::uint32_t k = 0; k < 500; ++k) {
    const auto weights = random_weights(k, 37);
    const auto counts = children(Resampling::systematic, weights, k);
    for (std::size_t j = 0; j < 37; ++j) EXPECT_LT(std::abs(counts[j] - 37 * weights[j]), 1.0) << k;
  }
}

TEST(Resampling, StratifiedStaysWithinTwoOfItsShare) {
  for (std::uint32_t k = 0; k < 500; ++k) {
    const auto weights = random_weights(k, 37);
    const auto counts = children(Resampling::stratified, weights, k);
    for (std::size_t j = 0; j < 37; ++j) EXPECT_LT(std::abs(counts[j] - 37 * weights[j]), 2.0) << k;
  }
}

TEST(Resampling, ResidualKeepsAtLeastTheFloor) {
  for (std::uint32_t k = 0; k < 500; ++k) {
    const auto weights = random_weights(k, 37);
    const auto counts = children(Resampling::residual, weights, k);
    for (std::size_t j = 0; j < 37; ++j) EXPECT_GE(counts[j], std::floor(37 * weights[j])) << k;
  }
}

}  // namespace
}  // namespace montecarta::engine
