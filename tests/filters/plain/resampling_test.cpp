// SPDX-License-Identifier: BSD-3-Clause
// The plain resampling against that of the engine, which divides large populations into parts.
#include "filters/plain/resampling.hpp"

#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

namespace montecarta::filters {
namespace {

/// Weights of a few heavy and many light particles, which add up to one.
std::vector<double> uneven_weights(std::size_t particles, std::uint64_t seed) {
  RngStream draw({.seed = seed, .purpose = Draw::test});
  std::vector<double> weights(particles);
  for (double& weight : weights) weight = std::exp(3.0 * draw.normal());
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights) weight /= sum;
  return weights;
}

class PlainResampling : public testing::TestWithParam<Resampling> {};

TEST_P(PlainResampling, DrawsTheParentsOfTheEngineForLargePopulations) {
  for (const std::size_t particles : {1023U, 1025U, 2100U, 5000U}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const std::vector<double> weights = uneven_weights(particles, seed);
      const StepContext context(seed, 0, 7, Parallel::serial());
      std::vector<std::uint32_t> expected(particles);
      draw_parents(GetParam(), weights, context, expected);
      EXPECT_EQ(plain::parents_by(GetParam(), weights, context), expected)
          << particles << " particles, seed " << seed;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(BothSchemes, PlainResampling,
                         testing::Values(Resampling::systematic, Resampling::stratified));

}  // namespace
}  // namespace montecarta::filters
