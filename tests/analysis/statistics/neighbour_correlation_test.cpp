// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/correlation.hpp"
#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kCorrelatedScans = 400;
constexpr double kNone = std::numeric_limits<double>::infinity();

/// A run whose scans go together as `correlation` says, of mean 0 and variance 1.
std::vector<double> autoregression(std::uint64_t run, double correlation) {
  RngStream draw({11, run, 0, 0, Draw::test});
  std::vector<double> values = {draw.normal()};
  const double rest = std::sqrt(1.0 - correlation * correlation);
  while (values.size() < kCorrelatedScans)
    values.push_back(correlation * values.back() + rest * draw.normal());
  return values;
}

// Pooled over 100 scans of 30 runs: one standard error is sqrt((1 - r^2) / 3000).
TEST(NeighbourCorrelation, FindsThatOfAnAutoregression) {
  for (const double r : {0.0, 0.6, 0.95}) {
    NeighbourCorrelation sums(kCorrelatedScans);
    for (std::uint64_t run = 0; run < 30; ++run) sums.add(autoregression(run, r), kNone);
    const std::vector<double> found = sums.result();
    ASSERT_EQ(found.size(), kCorrelatedScans - 1);
    for (const double one : found) EXPECT_NEAR(one, r, 5.0 * std::sqrt((1.0 - r * r) / 1500.0));
  }
}

TEST(NeighbourCorrelation, TellsHalvesOfARunApart) {
  NeighbourCorrelation sums(kCorrelatedScans);
  for (std::uint64_t run = 0; run < 50; ++run) {
    std::vector<double> values = autoregression(run, 0.95);
    const std::vector<double> white = autoregression(run + 50, 0.0);
    std::copy(white.begin() + 200, white.end(), values.begin() + 200);
    sums.add(values, kNone);
  }
  EXPECT_NEAR(sums.result().front(), 0.95, 0.03);
  EXPECT_NEAR(sums.result().back(), 0.0, 0.1);
}

TEST(NeighbourCorrelation, IsNotMovedByARunThatWentAstray) {
  NeighbourCorrelation sums(kCorrelatedScans);
  for (std::uint64_t run = 0; run < 30; ++run) {
    std::vector<double> values = autoregression(run, 0.0);
    if (run == 7) values[100] = values[101] = 1e20;
    sums.add(values, 10.0);
  }
  EXPECT_LT(sums.result()[100], 0.15);
}

TEST(NeighbourCorrelation, LeavesOutWhatIsNotANumberAndKnowsNothingOfNothing) {
  NeighbourCorrelation sums(3);
  EXPECT_EQ(sums.result(), (std::vector<double>{0.0, 0.0}));
  sums.add(std::vector<double>{1.0, std::nan(""), 2.0}, kNone);
  sums.add(std::vector<double>{2.0, 5.0, std::nan("")}, kNone);
  sums.add(std::vector<double>{3.0, 6.0, 7.0}, kNone);
  for (const double one : sums.result()) EXPECT_TRUE(one >= 0.0 && one < 1.0) << one;
}

}  // namespace
}  // namespace montecarta::analysis
