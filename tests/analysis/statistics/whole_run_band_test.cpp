// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/whole_run_band.hpp"

#include "analysis/statistics/t_quantile.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kBandScans = 200;
constexpr std::size_t kManyRuns = 1'000'000;  // their deviation is as good as known

WholeRunTest test_of(double correlation, std::size_t runs = kManyRuns) {
  return BandWalks(kBandScans).test(std::vector<double>(kBandScans - 1, correlation), runs, 0.95);
}

double deviate_of(double correlation) { return test_of(correlation).deviate; }

// Independent scans, of which the average says nothing of the greatest: each part has 1 -
// sqrt(0.95): the average at a deviate of 2.236, and (1 - 2 Phi(-c))^200 = sqrt(0.95) at c = 3.83
// (scipy.stats.norm).
TEST(WholeRunTest, IsSidaksWhereScansAreIndependent) {
  EXPECT_NEAR(deviate_of(0.0), 3.83, 0.08);
  EXPECT_NEAR(test_of(0.0).average_deviate, 2.236, 0.06);
}

TEST(WholeRunTest, IsThatOfOneScanWhereAllAreTheSame) {
  EXPECT_NEAR(deviate_of(1.0 - 1e-9), 1.960, 0.06);
  EXPECT_NEAR(test_of(1.0 - 1e-9).average_deviate, 1.960, 0.035);
}

// Of many scans the average varies far less than one scan, so that nothing limits the estimate of
// its deviation.
TEST(WholeRunTest, IsStudentsWhereFewRunsEstimateTheDeviation) {
  EXPECT_NEAR(test_of(0.0, 20).average_deviate, t_quantile(20, std::sqrt(0.95)), 0.07);
  EXPECT_NEAR(test_of(0.0, 20).deviate, 3.83, 0.08);
}

// |z| > c or |z| > a min(s, 1), s^2 a chi-square over its 19 degrees of freedom: with 4.017 % each,
// c = 2.052 and a = 2.269, either has 5 % (midpoint rule over s^2).
TEST(WholeRunTest, CountsWhatAnEstimatedDeviationAccusesBesidesTheBand) {
  EXPECT_NEAR(test_of(1.0 - 1e-9, 20).deviate, 2.052, 0.06);
  EXPECT_NEAR(test_of(1.0 - 1e-9, 20).average_deviate, 2.269, 0.06);
}

// Where a walk that goes far at one scan also has a far average, the parts share false alarms: of
// 400,000 walks of five scans numpy finds each part to have 4.03 %, the average a deviate of 2.051.
TEST(WholeRunTest, CountsOnceWhatBothPartsAccuse) {
  const WholeRunTest found = BandWalks(5).test(std::vector<double>(4, 0.9), kManyRuns, 0.95);
  EXPECT_NEAR(found.average_deviate, 2.051, 0.06);
}

TEST(WholeRunTest, NarrowsAsScansGoTogether) {
  EXPECT_LT(deviate_of(0.9), deviate_of(0.5));
  EXPECT_LT(deviate_of(0.99), deviate_of(0.9));
}

TEST(WholeRunTest, WidensWithTheLevelAndTheRun) {
  const BandWalks walks(kBandScans);
  const std::vector<double> correlation(kBandScans - 1, 0.5);
  const double deviate = walks.test(correlation, kManyRuns, 0.95).deviate;
  EXPECT_GT(walks.test(correlation, kManyRuns, 0.99).deviate, deviate);
  const std::vector<double> longer(2 * kBandScans - 1, 0.5);
  EXPECT_GT(BandWalks(2 * kBandScans).test(longer, kManyRuns, 0.95).deviate, deviate);
}

TEST(WholeRunTest, OfARunOfOneScanIsPointwise) {
  EXPECT_NEAR(BandWalks(1).test({}, kManyRuns, 0.95).deviate, 1.960, 0.08);
}

}  // namespace
}  // namespace montecarta::analysis
