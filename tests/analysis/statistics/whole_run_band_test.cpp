// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/whole_run_band.hpp"

#include "analysis/statistics/spread.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kBandScans = 200;
constexpr std::size_t kManyRuns = 1'000'000;  // their deviation is as good as known

WholeRunTest test_of(double correlation, std::size_t runs = kManyRuns) {
  return BandWalks(kBandScans)
      .test(std::vector<double>(kBandScans - 1, correlation), runs, 3, 0.95);
}

double deviate_of(double correlation) { return test_of(correlation).deviate; }

// Independent scans, of which the average says nothing of the greatest: (1 - p)(1 - p / 4) = 0.95
// at p = 4.03 %, the average at a deviate of 2.050, and (1 - 2 Phi(-c))^200 = 1 - p / 4 at c
// = 4.053 (scipy.stats.norm).
TEST(WholeRunTest, IsSidaksWhereScansAreIndependent) {
  EXPECT_NEAR(deviate_of(0.0), 4.053, 0.1);
  EXPECT_NEAR(test_of(0.0).average_deviate, 2.050, 0.06);
}

TEST(WholeRunTest, IsThatOfOneScanWhereAllAreTheSame) {
  EXPECT_NEAR(deviate_of(1.0 - 1e-9), 2.498, 0.1);
  EXPECT_NEAR(test_of(1.0 - 1e-9).average_deviate, 1.960, 0.035);
}

// Of many scans the average varies far less than one scan, so that nothing limits the estimate of
// its deviation.
TEST(WholeRunTest, IsStudentsWhereFewRunsEstimateTheDeviation) {
  EXPECT_NEAR(test_of(0.0, 20).average_deviate, t_quantile(20, 0.9597), 0.07);
  EXPECT_NEAR(test_of(0.0, 20).deviate, 4.053, 0.1);
}

// |z| > c or |z| > a min(s, 1), s^2 a chi-square over its 19 / (1 + 1/3) degrees of freedom: what
// the band rejects the average does as well (a million draws by numpy: 5.00 % at a = 2.209).
TEST(WholeRunTest, CountsWhatAnEstimatedDeviationRejectsBesidesTheBand) {
  EXPECT_NEAR(test_of(1.0 - 1e-9, 20).deviate, 2.498, 0.1);
  EXPECT_NEAR(test_of(1.0 - 1e-9, 20).average_deviate, 2.209, 0.06);
}

// Where a walk that goes far at one scan also has a far average, the parts share false alarms: of
// a million walks of five scans numpy finds the average to have 4.96 %, at a deviate of 1.962.
TEST(WholeRunTest, CountsOnceWhatBothPartsReject) {
  const WholeRunTest found = BandWalks(5).test(std::vector<double>(4, 0.9), kManyRuns, 3, 0.95);
  EXPECT_NEAR(found.average_deviate, 1.962, 0.06);
}

TEST(WholeRunTest, NarrowsAsScansGoTogether) {
  EXPECT_LT(deviate_of(0.9), deviate_of(0.5));
  EXPECT_LT(deviate_of(0.99), deviate_of(0.9));
}

TEST(WholeRunTest, WidensWithTheLevelAndTheRun) {
  const BandWalks walks(kBandScans);
  const std::vector<double> correlation(kBandScans - 1, 0.5);
  const double deviate = walks.test(correlation, kManyRuns, 3, 0.95).deviate;
  EXPECT_GT(walks.test(correlation, kManyRuns, 3, 0.99).deviate, deviate);
  const std::vector<double> longer(2 * kBandScans - 1, 0.5);
  EXPECT_GT(BandWalks(2 * kBandScans).test(longer, kManyRuns, 3, 0.95).deviate, deviate);
}

// Traces of powers of the matrix of exp(-lag / tau), tau far shorter than the run: 3/2; the same
// matrix of two scans by hand.
TEST(WholeRunTest, KnowsHowSkewedTheAverageIs) {
  EXPECT_NEAR(test_of(0.0).average_skew, 1.0, 1e-12);
  EXPECT_NEAR(test_of(1.0 - 1e-9).average_skew, 1.0, 1e-6);
  EXPECT_NEAR(test_of(0.8).average_skew, 1.5, 0.06);
  const std::vector<double> half = {0.5};
  const double two = BandWalks(2).test(half, kManyRuns, 3, 0.95).average_skew;
  EXPECT_NEAR(two, (2.0 + 6.0 * 0.5) * 2.0 / (3.0 * 3.0), 1e-12);
}

TEST(WholeRunTest, OfARunOfOneScanIsPointwise) {
  EXPECT_NEAR(BandWalks(1).test({}, kManyRuns, 3, 0.95).deviate, 2.498, 0.1);
}

}  // namespace
}  // namespace montecarta::analysis
