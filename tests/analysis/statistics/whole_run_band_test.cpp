// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/whole_run_band.hpp"

#include "analysis/statistics/correlation.hpp"
#include "analysis/statistics/group_sequential.hpp"
#include "analysis/statistics/nees_power.hpp"
#include "analysis/statistics/spread.hpp"
#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
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

constexpr double kDeviate = 1.96;

AverageLaw law_of(const std::vector<double>& runs) { return average_law(runs, 3, kDeviate, 1.0); }

// The average over one scan is the average NEES.
TEST(AverageLaw, IsThatOfTheChiSquareWhereRunsAreOneScanLong) {
  RngStream draw({5, 0, 0, 0, Draw::test});
  std::vector<double> nees(2000);
  for (double& value : nees) {
    value = 0.0;
    for (int i = 0; i < 3; ++i) {
      const double normal = draw.normal();
      value += normal * normal;
    }
  }
  const Interval exact = nees_bounds(2000, 3, 0.95), found = law_of(nees).bounds();
  EXPECT_NEAR(3.0 * found.lower, exact.lower, 0.01);
  EXPECT_NEAR(3.0 * found.upper, exact.upper, 0.01);
  EXPECT_FALSE(is_overdispersed(nees, 3));
}

TEST(AverageLaw, IsNeverWiderThanThatOfOneScan) {
  std::vector<double> astray(30, 3.0), beyond = astray;
  astray[4] = 1e20;
  beyond[4] = std::numeric_limits<double>::infinity();
  EXPECT_LT(3.0 * law_of(astray).bounds().upper, 10.0);
  EXPECT_TRUE(is_overdispersed(astray, 3));
  EXPECT_EQ(law_of(beyond).bounds().upper, law_of(astray).bounds().upper);
  EXPECT_TRUE(is_overdispersed(beyond, 3));
  EXPECT_TRUE(std::isinf(law_of({3.0, 3.0}).bounds().upper));
}

// The coefficient of variation of gamma samples is independent of their mean (Lukacs), so that runs
// which lie low by chance do not narrow the bounds.
TEST(AverageLaw, DoesNotDependOnTheScaleOfTheRuns) {
  const Interval once = law_of({2.0, 3.5, 2.5, 3.0}).bounds();
  const Interval twice = law_of({4.0, 7.0, 5.0, 6.0}).bounds();
  EXPECT_NEAR(twice.lower, once.lower, 1e-12);
  EXPECT_NEAR(twice.upper, once.upper, 1e-12);
}

TEST(AverageLaw, ReachesFartherDownWhereRunsAreMoreSkewed) {
  AverageLaw law{.variation = 0.3, .runs = 20, .deviate = 2.0};
  const Interval gamma = law.bounds();
  law.skew = 1.4;
  EXPECT_LT(law.bounds().lower, gamma.lower);
  EXPECT_LT(law.bounds().upper, gamma.upper);
}

// Of many runs all is normal: 1.96 and 1.96 + 1.282 deviations of sqrt(0.1 / 1e6).
TEST(LeastRatios, AddThePowersDeviate) {
  const AverageLaw law{.variation = 0.1, .runs = 1e6, .deviate = kDeviate};
  const Interval found = least_ratios(law, 0.9);
  EXPECT_NEAR(found.upper, 1.0 + 3.2415 * std::sqrt(1e-7), 1e-5);
  EXPECT_NEAR(found.lower, 1.0 - 3.2415 * std::sqrt(1e-7), 1e-5);
}

// (2 x 1.96 / log 1.1)^2 x 0.1 = 169.2 by the normal law.
TEST(RunsThatDecide, MakeTheIntervalNoLongerThanTheMargin) {
  AverageLaw law{.variation = 0.1, .runs = 10, .deviate = kDeviate};
  const std::uint64_t enough = runs_that_decide(law, 1.1);
  EXPECT_NEAR(static_cast<double>(enough), 169.0, 2.0);
  law.runs = static_cast<double>(enough);
  EXPECT_LE(law.bounds().upper / law.bounds().lower, 1.1);
  law.runs -= 1.0;
  EXPECT_GT(law.bounds().upper / law.bounds().lower, 1.1);
  EXPECT_EQ(runs_that_decide({.variation = 1e-9, .runs = 10, .deviate = kDeviate}, 1.1), 3u);
}

}  // namespace
}  // namespace montecarta::analysis
