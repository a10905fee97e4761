// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/whole_run_band.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace montecarta {
namespace {

constexpr std::size_t kBandScans = 200;

WholeRunTest test_of(double correlation) {
  return BandWalks(kBandScans).test(std::vector<double>(kBandScans - 1, correlation), 0.95);
}

double deviate_of(double correlation) { return test_of(correlation).deviate; }

// Independent scans, of which the average says nothing of the greatest: each part has 1 -
// sqrt(0.95), and (1 - 2 Phi(-c))^200 = sqrt(0.95) at c = 3.83 (scipy.stats.norm).
TEST(WholeRunTest, IsSidaksWhereScansAreIndependent) {
  EXPECT_NEAR(deviate_of(0.0), 3.83, 0.08);
  EXPECT_NEAR(test_of(0.0).average_level, std::sqrt(0.95), 0.004);
}

TEST(WholeRunTest, IsThatOfOneScanWhereAllAreTheSame) {
  EXPECT_NEAR(deviate_of(1.0 - 1e-9), 1.960, 0.06);
  EXPECT_NEAR(test_of(1.0 - 1e-9).average_level, 0.95, 0.004);
}

// Where a walk that goes far at one scan also has a far average, the parts share false alarms: of
// 400,000 walks of five scans numpy finds each part to have 4.03 %.
TEST(WholeRunTest, CountsOnceWhatBothPartsAccuse) {
  const WholeRunTest found = BandWalks(5).test(std::vector<double>(4, 0.9), 0.95);
  EXPECT_NEAR(found.average_level, 0.9597, 0.006);
}

TEST(WholeRunTest, NarrowsAsScansGoTogether) {
  EXPECT_LT(deviate_of(0.9), deviate_of(0.5));
  EXPECT_LT(deviate_of(0.99), deviate_of(0.9));
}

TEST(WholeRunTest, WidensWithTheLevelAndTheRun) {
  const BandWalks walks(kBandScans);
  const std::vector<double> correlation(kBandScans - 1, 0.5);
  const double deviate = walks.test(correlation, 0.95).deviate;
  EXPECT_GT(walks.test(correlation, 0.99).deviate, deviate);
  const std::vector<double> longer(2 * kBandScans - 1, 0.5);
  EXPECT_GT(BandWalks(2 * kBandScans).test(longer, 0.95).deviate, deviate);
}

TEST(WholeRunTest, OfARunOfOneScanIsPointwise) {
  EXPECT_NEAR(BandWalks(1).test({}, 0.95).deviate, 1.960, 0.08);
}

}  // namespace
}  // namespace montecarta
