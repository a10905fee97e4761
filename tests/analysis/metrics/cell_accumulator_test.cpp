// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/cell_accumulator.hpp"

#include "analysis/metrics/score_intervals.hpp"
#include "tests/analysis/synthetic_runs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace montecarta {
namespace {

CellAnalysis analyze_runs(const SyntheticStudy& study, std::uint64_t runs) {
  const auto times = study.times();
  const BandWalks walks(times.size());
  CellAccumulator sums(times, 0.95, walks);
  RunMetrics metrics;
  for (std::uint64_t run = 0; run < runs; ++run) {
    const RunRows rows = study.run(run);
    metrics.measure(rows, 0, times);
    sums.add(rows, metrics);
  }
  return sums.result();
}

const NeesResult& nees_of(const CellAnalysis& cell, ErrorBlock block,
                          Moments moments = Moments::spread) {
  const NeesResult* found = cell.find_nees(block, moments);
  EXPECT_NE(found, nullptr);
  return *found;
}

TEST(CellAccumulator, FindsAPerfectFilterInsideItsBandAsOftenAsPromised) {
  SyntheticStudy study;
  study.scans = 2000;
  const CellAnalysis cell = analyze_runs(study, 30);
  for (const ErrorBlock block : kErrorBlocks) {
    const NeesResult& nees = nees_of(cell, block);
    const double d = static_cast<double>(nees.series.dimension);
    const double share_error = std::sqrt(0.95 * 0.05 / 2000.0);
    EXPECT_NEAR(nees.consistency.share_inside, 0.95, 5.0 * share_error) << d;
    EXPECT_NEAR(nees.consistency.mean, d, 5.0 * std::sqrt(2.0 * d / (30.0 * 2000.0))) << d;
    EXPECT_EQ(nees.consistency.verdict, Verdict::consistent);
    EXPECT_NEAR(nees.series.bounds[7].upper, nees_bounds(30, nees.series.dimension, 0.95).upper,
                1e-12);
  }
}

TEST(CellAccumulator, FindsInflatedErrorsAboveTheBand) {
  SyntheticStudy study;
  study.inflation = 1.5;
  const CellAnalysis cell = analyze_runs(study, 30);
  const Consistency pose = cell.consistency();
  EXPECT_NEAR(pose.mean, 3.0 * 2.25, 5.0 * std::sqrt(6.0 / (30.0 * 400.0)) * 2.25);
  EXPECT_EQ(pose.verdict, Verdict::inconsistent);
  EXPECT_DOUBLE_EQ(*pose.lasting_exit, 0.2);
}

TEST(CellAccumulator, FindsTooLargeACovarianceBelowTheBand) {
  SyntheticStudy study;
  study.inflation = 0.6;
  EXPECT_EQ(analyze_runs(study, 30).consistency().verdict, Verdict::conservative);
}

TEST(CellAccumulator, FindsABiasAndItsRmse) {
  SyntheticStudy study;
  study.bias = {0.5, 0.0, 0.0};
  const CellAnalysis cell = analyze_runs(study, 40);
  const double mse = 0.25 + 0.04 + 0.09;  // bias squared and both variances
  EXPECT_NEAR(cell.error.position_mse.mean, mse, 5.0 * cell.error.position_mse.standard_error());
  EXPECT_NEAR(cell.error.heading_mse.mean, 0.0025, 5.0 * cell.error.heading_mse.standard_error());
  EXPECT_GT(cell.error.position_mse.standard_error(), 0.0);
  EXPECT_EQ(cell.consistency().verdict, Verdict::inconsistent);
  EXPECT_NEAR(nees_of(cell, ErrorBlock::heading).consistency.mean, 1.0, 0.1);
}

TEST(CellAccumulator, SaysHowSureItIs) {
  SyntheticStudy study;
  study.inflation = 1.5;
  CellAnalysis cell = analyze_runs(study, 30);
  put_score_intervals(cell, 0.95);
  const Consistency pose = cell.consistency();
  EXPECT_LT(pose.average_bounds.upper, 3.2);
  EXPECT_LT(pose.average_interval.lower, 6.75);
  EXPECT_GT(pose.average_interval.upper, 6.75);
  ASSERT_TRUE(pose.exit_interval);
  EXPECT_DOUBLE_EQ(pose.exit_interval->lower, 0.2);
  EXPECT_LT(cell.lower.position_rmse, cell.error.position_rmse.mean);
  EXPECT_GT(cell.upper.position_rmse, cell.error.position_rmse.mean);
  EXPECT_TRUE(std::isnan(cell.lower.ess));
  ASSERT_TRUE(cell.credibility && cell.anatomy);
  EXPECT_NEAR(cell.credibility->inclination, 20.0 * std::log10(1.5), 0.3);
  EXPECT_NEAR(cell.anatomy->happened[2].back() / cell.anatomy->believed[2].back(), 1.5, 0.5);
  EXPECT_EQ(cell.run_exits.size(), 30u);
}

TEST(CellAccumulator, WrapsTheHeading) {
  SyntheticStudy study;  // its heading turns through pi again and again
  const CellAnalysis cell = analyze_runs(study, 10);
  EXPECT_LT(cell.error.heading_rmse.mean, 0.06);
}

TEST(CellAccumulator, KnowsAPairOfRunsByHand) {
  const std::vector<double> times = {0.2, 0.4};
  const BandWalks walks(times.size());
  CellAccumulator sums(times, 0.95, walks);
  RunMetrics metrics;
  for (const double error : {1.0, 3.0}) {
    RunRows rows;
    rows.truth = {error, 0.0, 0.0, 0.0, error, 0.1};
    rows.spread.mean.assign(6, 0.0);
    rows.cpu_seconds = error;
    metrics.measure(rows, 0, times);
    sums.add(rows, metrics);
  }
  const CellAnalysis cell = sums.result();
  EXPECT_EQ(cell.complete, 2u);
  EXPECT_TRUE(cell.nees.empty());
  EXPECT_EQ(cell.consistency().verdict, Verdict::untested);
  EXPECT_DOUBLE_EQ(cell.error.position_rmse.mean, 2.0);
  EXPECT_DOUBLE_EQ(cell.error.position_rmse.sd, std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(cell.error.position_rmse.standard_error(), 1.0);
  EXPECT_DOUBLE_EQ(cell.error.position_mse.mean, 5.0);
  EXPECT_DOUBLE_EQ(cell.error.position_variance.mean, 0.0);
  EXPECT_DOUBLE_EQ(cell.error.heading_mean.mean, 0.05);
  EXPECT_DOUBLE_EQ(cell.error.position_over_time[1], std::sqrt(5.0));
  EXPECT_DOUBLE_EQ(cell.cpu_seconds.mean, 2.0);
}

TEST(CellAccumulator, LetsTheMixtureLeadAndKeepsTheSpread) {
  const SyntheticStudy study;
  const auto times = study.times();
  const BandWalks walks(times.size());
  CellAccumulator sums(times, 0.95, walks);
  RunMetrics metrics;
  for (std::uint64_t run = 0; run < 30; ++run) {
    RunRows rows = study.run(run);
    rows.mixture = rows.spread;
    for (double& element : rows.spread.covariance) element *= 0.25;
    metrics.measure(rows, 0, times);
    sums.add(rows, metrics);
  }
  const CellAnalysis cell = sums.result();
  EXPECT_EQ(cell.leading, Moments::mixture);
  EXPECT_EQ(cell.consistency().verdict, Verdict::consistent);
  EXPECT_EQ(nees_of(cell, ErrorBlock::pose).consistency.verdict, Verdict::inconsistent);
  EXPECT_NEAR(nees_of(cell, ErrorBlock::pose).consistency.mean, 4.0 * cell.consistency().mean,
              1e-9);
}

TEST(CellAccumulator, CountsWhatIsSingularOrUndefined) {
  SyntheticStudy study;
  study.scans = 3;
  const auto times = study.times();
  const BandWalks walks(times.size());
  CellAccumulator sums(times, 0.95, walks);
  RunMetrics metrics;
  for (std::uint64_t run = 0; run < 4; ++run) {
    RunRows rows = study.run(run);
    if (run == 1) std::fill_n(rows.spread.covariance.begin(), 9, 0.0);
    if (run == 2) rows.spread.covariance[9] = std::numeric_limits<double>::quiet_NaN();
    metrics.measure(rows, 0, times);
    sums.add(rows, metrics);
  }
  const CellAnalysis cell = sums.result();
  const NeesSeries& series = nees_of(cell, ErrorBlock::pose).series;
  EXPECT_EQ(series.samples, 12u);
  EXPECT_EQ(series.floored, 1u);
  EXPECT_EQ(series.undefined, 1u);
  EXPECT_EQ(series.runs, (std::vector<std::uint32_t>{4, 3, 4}));
  EXPECT_DOUBLE_EQ(series.bounds[1].upper, nees_bounds(3, 3, 0.95).upper);
  EXPECT_TRUE(std::isfinite(series.average[1]));
}

TEST(CellAccumulator, SummarisesParticles) {
  const std::vector<double> times = {0.2, 0.4};
  const BandWalks walks(times.size());
  CellAccumulator sums(times, 0.95, walks);
  RunMetrics metrics;
  RunRows rows;
  rows.truth.assign(6, 0.0);
  rows.spread.mean.assign(6, 0.0);
  rows.ess = {4.0, 2.0};
  rows.resampled = {1, 0};
  rows.ancestor = {0, 1, 2, 3, 0, 0, 0, 1};
  metrics.measure(rows, 4, times);
  sums.add(rows, metrics);
  const CellAnalysis cell = sums.result();
  ASSERT_TRUE(cell.weights && cell.diversity);
  EXPECT_DOUBLE_EQ(cell.weights->ess.mean, 3.0);
  EXPECT_DOUBLE_EQ(cell.weights->resampling_rate.mean, 0.5);
  EXPECT_DOUBLE_EQ(cell.diversity->root.mean, 3.0);
  EXPECT_DOUBLE_EQ(cell.diversity->final_root.mean, 2.0);
}

TEST(CellAccumulator, SumsAssociationsOverARunAndAveragesOverRuns) {
  const std::vector<double> times = {0.2, 0.4};
  const BandWalks walks(times.size());
  CellAccumulator sums(times, 0.95, walks);
  RunMetrics metrics;
  RunRows rows;
  rows.truth.assign(6, 0.0);
  rows.spread.mean.assign(6, 0.0);
  metrics.measure(rows, 0, times);
  sums.add(rows, metrics);
  EXPECT_FALSE(sums.result().association);
  CellAccumulator counted(times, 0.95, walks);
  for (const double wrong : {1.0, 4.0}) {
    rows.association = {{3.0, 2.5}, {wrong, 0.5}, {0.0, 0.0}, {1.0, 0.0}, {0.0, 2.0}};
    counted.add(rows, metrics);
  }
  const CellAnalysis cell = counted.result();
  ASSERT_TRUE(cell.association);
  EXPECT_DOUBLE_EQ(cell.association->correct.mean, 5.5);
  EXPECT_DOUBLE_EQ(cell.association->wrong.mean, 3.0);
  EXPECT_DOUBLE_EQ(cell.association->missed.mean, 1.0);
  EXPECT_DOUBLE_EQ(cell.association->clutter.mean, 2.0);
  EXPECT_DOUBLE_EQ(cell.scores[1].wrong, 4.5);
}

}  // namespace
}  // namespace montecarta
