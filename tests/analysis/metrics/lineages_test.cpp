// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/lineages.hpp"

#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace montecarta::analysis {
namespace {

std::vector<double> seconds(std::size_t scans) {
  std::vector<double> times;
  for (std::size_t s = 0; s < scans; ++s) times.push_back(static_cast<double>(s + 1));
  return times;
}

/// Twenty scans, one a second, of four particles: nobody is replaced but before scan 10 (from 0),
/// when 0 and 1 take over, and before scan 15, when all become children of 2, who is one of 1's.
RunRows two_resamplings() {
  RunRows rows;
  for (int s = 0; s < 20; ++s) {
    const std::vector<std::uint32_t> parents = s == 10   ? std::vector<std::uint32_t>{0, 0, 1, 1}
                                               : s == 15 ? std::vector<std::uint32_t>{2, 2, 2, 2}
                                                         : std::vector<std::uint32_t>{0, 1, 2, 3};
    rows.ancestor.insert(rows.ancestor.end(), parents.begin(), parents.end());
  }
  return rows;
}

// Twenty scans are all looked at. A scan s >= 15 looks back s - 14 seconds to the common ancestor.
TEST(Lineages, KnowTwoResamplingsByHand) {
  const Lineages found = LineageWalker().walk(two_resamplings(), 4, seconds(20), {});
  EXPECT_DOUBLE_EQ(found.coalesced_share, 5.0 / 20.0);
  EXPECT_NEAR(found.coalescence, (1.0 + 2.0 + 3.0 + 4.0 + 5.0) / 5.0, 1e-6);
  // One second back: scan 10 sees 2, scan 15 sees 1, the others 4.
  EXPECT_DOUBLE_EQ(found.ancestors[0], (18 * 4.0 + 2.0 + 1.0) / 20.0);
  EXPECT_DOUBLE_EQ(found.ancestors[4], 1.0);
  EXPECT_TRUE(std::isnan(found.ancestors[6]));
  EXPECT_TRUE(std::isnan(found.monte_carlo_variance));
}

// Independent particles that are never resampled: the variance of their mean is variance / M.
TEST(Lineages, GiveTheVarianceOfAMeanOfIndependentParticles) {
  constexpr std::size_t kParticles = 500, kSeconds = 40;
  RngStream draw({31, 0, 0, 0, Draw::test});
  RunRows rows;
  for (std::size_t s = 0; s < kSeconds; ++s) {
    for (std::uint32_t i = 0; i < kParticles; ++i) {
      rows.ancestor.push_back(i);
      rows.log_weight.push_back(-std::log(static_cast<double>(kParticles)));
      for (const double value : {10.0 + 2.0 * draw.normal(), 1.0 * draw.normal() - 5.0, 0.0})
        rows.particle_pose.push_back(value);
    }
  }
  const Lineages found = LineageWalker().walk(rows, kParticles, seconds(kSeconds), {});
  const double expected = (4.0 + 1.0) / static_cast<double>(kParticles);
  EXPECT_NEAR(found.monte_carlo_variance, expected, 0.1 * expected);
}

// Copies tell nothing new: with every ancestor doubled the variance is that of half as many.
TEST(Lineages, CountFamiliesAsOne) {
  constexpr std::size_t kParticles = 400, kSeconds = 12;
  RngStream draw({37, 0, 0, 0, Draw::test});
  RunRows rows;
  std::vector<double> x(kParticles);
  for (std::size_t i = 0; i < kParticles; i += 2) x[i] = x[i + 1] = draw.normal();
  for (std::size_t s = 0; s < kSeconds; ++s) {
    for (std::uint32_t i = 0; i < kParticles; ++i) {
      rows.ancestor.push_back(s == 8 ? i - i % 2 : i);
      rows.log_weight.push_back(-std::log(static_cast<double>(kParticles)));
      for (const double value : {x[i], 0.0, 0.0}) rows.particle_pose.push_back(value);
    }
  }
  const Lineages found = LineageWalker().walk(rows, kParticles, seconds(kSeconds), {});
  const double of_half = 1.0 / (0.5 * static_cast<double>(kParticles));
  EXPECT_NEAR(found.monte_carlo_variance, of_half, 0.25 * of_half);
}

// Families {0, 1} and {2} of the last ten seconds, with weights 0.5, 0.2, 0.3 at x = 10, 12, 20:
// the mean is 13.4, and the families pull it by 1.98 to either side.
TEST(Lineages, WeighFamiliesByHand) {
  RunRows rows;
  for (int s = 0; s < 12; ++s) {
    rows.ancestor.insert(rows.ancestor.end(), {0, s == 5 ? 0u : 1u, 2});
    for (const double weight : {0.5, 0.2, 0.3}) rows.log_weight.push_back(std::log(weight));
    for (const double x : {10.0, 12.0, 20.0}) {
      rows.particle_pose.insert(rows.particle_pose.end(), {x, 7.0, 0.0});
    }
  }
  const Lineages found = LineageWalker().walk(rows, 3, seconds(12), {});
  EXPECT_NEAR(found.monte_carlo_variance, 2.0 * 1.98 * 1.98, 1e-9);
}

// Of 64 scans every second one is looked at, the last one among them.
TEST(Lineages, LookAtErrorsOfTheSameScans) {
  RunRows rows;
  std::vector<double> squares;
  for (std::uint32_t s = 0; s < 64; ++s) {
    rows.ancestor.insert(rows.ancestor.end(), {0, 1});
    squares.push_back(static_cast<double>(s));
  }
  EXPECT_DOUBLE_EQ(LineageWalker().walk(rows, 2, seconds(64), squares).squared_error, 32.0);
}

TEST(LineageSums, AverageWhatRunsHave) {
  Lineages one, other;
  one.ancestors.fill(2.0);
  one.coalescence = std::nan("");
  one.monte_carlo_variance = 0.5;
  one.squared_error = 2.0;
  other = one;
  other.coalescence = 4.0;
  other.ancestors[6] = std::nan("");
  LineageSums sums;
  sums.add(one);
  sums.add(other);
  EXPECT_DOUBLE_EQ(sums.result().coalescence, 4.0);
  EXPECT_DOUBLE_EQ(sums.result().ancestors[6], 2.0);
  EXPECT_DOUBLE_EQ(sums.result().monte_carlo_share, 0.25);
}

}  // namespace
}  // namespace montecarta::analysis
