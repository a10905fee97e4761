// SPDX-License-Identifier: BSD-3-Clause
// Law: a row belongs to the scan that other runs have at its time, or to the scan of its number if
// no run shares its times.
#include "experiments/judging/scan_clock.hpp"

#include <gmock/gmock.h>

#include <optional>
#include <span>

namespace montecarta::experiments {
namespace {

using testing::ElementsAre;
using Files = TimesOfRuns;

ScanClock clock_of(const Files& files, double tolerance = 1e-6) {
  return {std::span(&files, 1), tolerance};
}

TEST(ScanClock, HasEveryTimeOfRunsThatStartLateOrDropAFrame) {
  const Files files = {{0, 1, 2, 3}, {0, 1, 3, 4}, {2, 3, 4}};
  const ScanClock clock = clock_of(files);
  EXPECT_TRUE(clock.is_common());
  EXPECT_THAT(clock.times(), ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(clock.scans_of(files[0]), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(clock.scans_of(files[1]), ElementsAre(0, 1, 3, 4));
  EXPECT_THAT(clock.scans_of(files[2]), ElementsAre(2, 3, 4));
}

TEST(ScanClock, TakesTimesWithinTheToleranceAsOneScanAtTheTimesOfTheLongestFile) {
  const Files files = {{0.01, 1.01}, {0.0, 1.0, 2.0}, {0.009, 0.991, 1.99}};
  const ScanClock clock = clock_of(files, 0.01);
  EXPECT_TRUE(clock.is_common());
  EXPECT_THAT(clock.times(), ElementsAre(0.0, 1.0, 2.0));
  EXPECT_THAT(clock.scans_of(files[0]), ElementsAre(0, 1));
  EXPECT_THAT(clock.scans_of(files[2]), ElementsAre(0, 1, 2));
}

TEST(ScanClock, CountsTheRowsOfRunsWithClocksOfTheirOwn) {
  const Files files = {{0, 1, 2, 3}, {10.3, 11.3, 12.4}, {0.5, 1.6, 2.4}};
  const ScanClock clock = clock_of(files);
  EXPECT_FALSE(clock.is_common());
  EXPECT_THAT(clock.times(), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(clock.scans_of(files[1]), ElementsAre(0, 1, 2));
}

TEST(ScanClock, IsCommonIfTwoClocksTakeTurnsOrSomeRunsEndEarly) {
  const Files turns = {{0.0, 1.0, 2.0}, {0.4, 1.4, 2.4}, {0.0, 1.0, 2.0}, {0.4, 1.4, 2.4}};
  EXPECT_THAT(clock_of(turns).times(), ElementsAre(0.0, 0.4, 1.0, 1.4, 2.0, 2.4));
  EXPECT_TRUE(clock_of({{0, 1, 2, 3, 4, 5, 6}, {0, 1}}).is_common());
  EXPECT_FALSE(clock_of({{0, 1, 2, 3, 4, 5, 6}, {100, 101}}).is_common());
}

TEST(ScanClock, IsThatOfEachEstimator) {
  const std::vector<Files> cells = {{{0.0, 0.1, 0.2, 0.3, 0.4}}, {{0.0, 0.15, 0.3}}};
  const ScanClock clock(cells, 1e-6);
  EXPECT_TRUE(clock.is_common());
  EXPECT_THAT(clock.times(), ElementsAre(0.0, 0.1, 0.15, 0.2, 0.3, 0.4));
  EXPECT_EQ(clock.missed_after(0.3, 1), std::nullopt) << "it has its own rate";
}

TEST(ScanClock, KnowsWhichRunEndsEarly) {
  Files files(3);
  for (int k = 0; k < 100; ++k) {
    files[0].push_back(k);
    if (k < 97) files[1].push_back(k);
    if (k < 50) files[2].push_back(k);
  }
  const ScanClock clock = clock_of(files);
  EXPECT_EQ(clock.missed_after(96.0, 0), std::nullopt) << "a few rows";
  EXPECT_TRUE(clock.missed_after(49.0, 0).has_value());
}

TEST(ScanClock, IsThatOfASingleFile) {
  const Files files = {{0.1, 0.7}};
  EXPECT_TRUE(clock_of(files).is_common());
  EXPECT_THAT(clock_of(files).times(), ElementsAre(0.1, 0.7));
}

}  // namespace
}  // namespace montecarta::experiments
