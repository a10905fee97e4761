// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/group_sequential.hpp"

#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace montecarta::analysis {
namespace {

// P. Armitage, C. K. McPherson, B. C. Rowe: Repeated significance tests on accumulating data, 1969:
// two looks at a normal sum after equal numbers, each at 5 %, find 8.3 %.
TEST(CrossingProbability, IsThatOfTheTables) {
  EXPECT_NEAR(crossing_probability(1, 0.05), 0.05, 1e-6);
  EXPECT_NEAR(crossing_probability(2, 0.05), 0.0831, 5e-5);
  EXPECT_NEAR(crossing_probability(2, 0.0294), 0.05, 5e-5);  // Pocock's boundary 2.178
}

// 40,000 sums: five standard errors are 0.005.
TEST(CrossingProbability, IsThatOfSums) {
  constexpr int kSums = 40'000;
  int crossed = 0;
  for (std::uint64_t i = 0; i < kSums; ++i) {
    RngStream draw({.seed = 1, .run = i, .purpose = Draw::test});
    double sum = draw.normal(), runs = 1.0;
    bool outside = std::abs(sum) > 2.5758293;  // 1 %
    for (int look = 1; look < 6; ++look) {
      sum += std::sqrt(runs) * draw.normal();
      runs *= 2.0;
      outside = outside || std::abs(sum) > 2.5758293 * std::sqrt(runs);
    }
    crossed += outside ? 1 : 0;
  }
  EXPECT_NEAR(crossed / double{kSums}, crossing_probability(6, 0.01), 0.005);
}

TEST(LevelOfALook, SharesTheErrorsAmongLooks) {
  EXPECT_EQ(level_of_a_look(0.95, 1), 0.95);
  double before = 0.95;
  for (const std::uint64_t looks : {2U, 3U, 6U, 20U}) {
    const double level = level_of_a_look(0.95, looks);
    EXPECT_GT(level, before);
    EXPECT_LT(level, 1.0 - 0.05 / static_cast<double>(looks)) << "Bonferroni's is the greatest";
    before = level;
  }
  EXPECT_NEAR(level_of_a_look(0.95, 2), 0.9718, 1e-4);
}

}  // namespace
}  // namespace montecarta::analysis
