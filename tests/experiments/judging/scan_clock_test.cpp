// SPDX-License-Identifier: BSD-3-Clause
// Law: a row belongs to the scan that other runs have at its time, or to the scan of its number if
// no run shares its times.
#include "experiments/judging/scan_clock.hpp"

#include <gmock/gmock.h>

namespace montecarta::experiments {
namespace {

using testing::ElementsAre;
using Files = std::vector<std::vector<double>>;

TEST(ScanClock, HasEveryTimeOfRunsThatStartLateOrDropAFrame) {
  const Files files = {{0, 1, 2, 3}, {0, 1, 3, 4}, {2, 3, 4}};
  const ScanClock clock(files, 1e-6);
  EXPECT_TRUE(clock.is_common());
  EXPECT_THAT(clock.times(), ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(clock.scans_of(files[0]), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(clock.scans_of(files[1]), ElementsAre(0, 1, 3, 4));
  EXPECT_THAT(clock.scans_of(files[2]), ElementsAre(2, 3, 4));
}

TEST(ScanClock, TakesTimesWithinTheToleranceAsOneScanAtTheTimesOfTheLongestFile) {
  const Files files = {{0.01, 1.01}, {0.0, 1.0, 2.0}, {0.009, 0.991, 1.99}};
  const ScanClock clock(files, 0.01);
  EXPECT_TRUE(clock.is_common());
  EXPECT_THAT(clock.times(), ElementsAre(0.0, 1.0, 2.0));
  EXPECT_THAT(clock.scans_of(files[0]), ElementsAre(0, 1));
  EXPECT_THAT(clock.scans_of(files[2]), ElementsAre(0, 1, 2));
}

TEST(ScanClock, CountsTheRowsOfRunsWithClocksOfTheirOwn) {
  const Files files = {{0, 1, 2, 3}, {10.3, 11.3, 12.4}, {0.5, 1.6, 2.4}};
  const ScanClock clock(files, 1e-6);
  EXPECT_FALSE(clock.is_common());
  EXPECT_THAT(clock.times(), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(clock.scans_of(files[1]), ElementsAre(0, 1, 2));
}

TEST(ScanClock, CountsRowsIfTwoClocksTakeTurns) {
  const Files files = {{0.0, 1.0, 2.0}, {0.4, 1.4, 2.4}, {0.0, 1.0, 2.0}, {0.4, 1.4, 2.4}};
  EXPECT_FALSE(ScanClock(files, 1e-6).is_common());
}

TEST(ScanClock, IsThatOfASingleFile) {
  const Files files = {{0.1, 0.7}};
  EXPECT_TRUE(ScanClock(files, 1e-6).is_common());
  EXPECT_THAT(ScanClock(files, 1e-6).times(), ElementsAre(0.1, 0.7));
}

}  // namespace
}  // namespace montecarta::experiments
