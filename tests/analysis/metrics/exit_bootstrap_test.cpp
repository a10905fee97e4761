// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/exit_bootstrap.hpp"

#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kExitScans = 200;
constexpr double kNoExit = std::numeric_limits<double>::infinity();

std::vector<double> seconds() {
  std::vector<double> times;
  for (std::size_t s = 0; s < kExitScans; ++s) times.push_back(static_cast<double>(s + 1));
  return times;
}

/// A NEES of three components that grows by `growth` a scan from scan 50 on.
std::vector<double> growing(std::uint64_t run, double growth) {
  RngStream draw({29, run, 0, 0, Draw::test});
  std::vector<double> nees;
  for (std::size_t s = 0; s < kExitScans; ++s) {
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) {
      const double normal = draw.normal();
      sum += normal * normal;
    }
    nees.push_back(sum * (s < 50 ? 1.0 : 1.0 + growth * static_cast<double>(s - 50)));
  }
  return nees;
}

Interval exits_of(double growth, std::uint64_t runs) {
  ExitBootstrap bootstrap(kExitScans);
  for (std::uint64_t run = 0; run < runs; ++run) bootstrap.add(growing(run, growth));
  return middle_of(bootstrap.lasting_exits(seconds(), 3, 0.95), 0.95);
}

TEST(ExitBootstrap, HoldsTheTimeAtWhichTheAverageBeginsToStayAbove) {
  const Interval few = exits_of(0.05, 30), many = exits_of(0.05, 400);
  EXPECT_GT(few.lower, 50.0);
  EXPECT_LT(few.upper, 90.0);
  EXPECT_LT(many.upper - many.lower, few.upper - few.lower);
  EXPECT_LT(many.lower, 62.0);  // 400 runs detect a NEES 1.2 times too large
}

TEST(ExitBootstrap, SaysNeverOfAConsistentFilter) { EXPECT_EQ(exits_of(0.0, 30).lower, kNoExit); }

TEST(ExitBootstrap, LeavesOutWhatIsNotANumberAndSurvivesTheHuge) {
  ExitBootstrap bootstrap(kExitScans);
  for (std::uint64_t run = 0; run < 20; ++run) {
    std::vector<double> nees = growing(run, 0.0);
    if (run == 3) std::ranges::fill(nees, std::nan(""));
    if (run == 4) nees[100] = 1e300;
    bootstrap.add(nees);
  }
  EXPECT_EQ(middle_of(bootstrap.lasting_exits(seconds(), 3, 0.95), 0.95).lower, kNoExit);
}

TEST(MiddleOf, CutsBothTails) {
  std::vector<double> values;
  for (int k = 1; k <= 40; ++k) values.push_back(k == 40 ? kNoExit : k);
  EXPECT_EQ(middle_of(values, 0.95).lower, 2.0);
  EXPECT_EQ(middle_of(values, 0.95).upper, 39.0);
  EXPECT_EQ(middle_of(values, 0.999).upper, kNoExit);
}

}  // namespace
}  // namespace montecarta::analysis
