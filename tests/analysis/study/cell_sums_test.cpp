// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/cell_sums.hpp"

#include "analysis/statistics/spread.hpp"
#include "analysis/study/error_moments.hpp"
#include "analysis/study/verdict_table.hpp"
#include "tests/analysis/reported.hpp"
#include "tests/analysis/synthetic_runs.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace montecarta::analysis {
namespace {

/// Adds up runs that are given as plain rows.
class RowSums {
 public:
  explicit RowSums(std::vector<double> times) : times_(std::move(times)) {}

  void add(const RunRows& rows, std::size_t particles = 0) {
    run_.rows = rows;
    run_.measure(criteria_, particles);
    sums_.add(run_);
  }
  CellAnalysis result() {
    CellAnalysis cell;
    sums_.put(cell);
    return cell;
  }

 private:
  std::vector<double> times_;
  RunCriteria criteria_ = criteria_of_scans(times_);
  CellSums sums_{criteria_};
  MeasuredRun run_;
};

CellAnalysis analyze_runs(const SyntheticStudy& study, std::uint64_t runs) {
  RowSums sums(study.times());
  for (std::uint64_t run = 0; run < runs; ++run) sums.add(study.run(run));
  return sums.result();
}

const NeesResult& nees_of(const CellAnalysis& cell, ErrorBlock block,
                          Moments moments = Moments::spread) {
  const NeesResult* found = cell.find_nees(block, moments);
  EXPECT_NE(found, nullptr);
  return *found;
}

TEST(CellSums, FindsAPerfectFilterInsideItsBandAsOftenAsPromised) {
  SyntheticStudy study;
  study.scans = 2000;
  const CellAnalysis cell = analyze_runs(study, 30);
  for (const ErrorBlock block : kErrorBlocks) {
    const NeesResult& nees = nees_of(cell, block);
    const double d = static_cast<double>(nees.series.dimension);
    const double share_error = std::sqrt(0.95 * 0.05 / 2000.0);
    EXPECT_NEAR(nees.share_inside(), 0.95, 5.0 * share_error) << d;
    EXPECT_NEAR(nees.mean, d, 5.0 * std::sqrt(2.0 * d / (30.0 * 2000.0))) << d;
    EXPECT_NEAR(nees.series.bounds[7].upper, nees_bounds(30, nees.series.dimension, 0.95).upper,
                1e-12);
  }
  EXPECT_EQ(cell.verdict.answer, Answer::consistent);
}

TEST(CellSums, FindsInflatedErrorsAboveTheBandAndSaysHowSureItIs) {
  SyntheticStudy study;
  study.inflation = 1.5;
  const CellAnalysis cell = analyze_runs(study, 30);
  const NeesResult& pose = nees_of(cell, ErrorBlock::pose);
  EXPECT_NEAR(pose.mean, 3.0 * 2.25, 5.0 * std::sqrt(6.0 / (30.0 * 400.0)) * 2.25);
  EXPECT_EQ(cell.verdict.answer, Answer::optimistic);
  EXPECT_LT(cell.verdict.ratio().lower, 2.25);
  EXPECT_GT(cell.verdict.ratio().upper, 2.25);
  EXPECT_GT(cell.verdict.ratio().lower, 2.1);
  EXPECT_LT(pose.average_interval.lower, 6.75);
  EXPECT_GT(pose.average_interval.upper, 6.75);
  EXPECT_LT(cell.interval_of("position_rmse").lower, cell.over_runs("position_rmse").mean);
  EXPECT_GT(cell.interval_of("position_rmse").upper, cell.over_runs("position_rmse").mean);
  EXPECT_TRUE(std::isnan(cell.interval_of("ess").lower));
  const ErrorsOverTime* errors = cell.find<ErrorsOverTime>();
  ASSERT_NE(errors, nullptr);
  EXPECT_NEAR(errors->rms[2].back() / errors->believed[2].back(), 1.5, 0.5);
}

TEST(CellSums, FindsTooLargeACovarianceBelowTheBand) {
  SyntheticStudy study;
  study.inflation = 0.6;
  EXPECT_EQ(analyze_runs(study, 30).verdict.answer, Answer::conservative);
}

TEST(CellSums, AnErrorIsTheEstimateLessTheTruth) {
  SyntheticStudy study;
  study.bias = {0.0, 0.0, 0.2};
  const CellAnalysis cell = analyze_runs(study, 40);
  const std::vector<double>& bias = cell.find<ErrorsOverTime>()->mean[2];
  EXPECT_NEAR(mean_of_finite(bias), 0.2, 0.01);
}

TEST(CellSums, FindsABiasAndItsRmse) {
  SyntheticStudy study;
  study.bias = {0.5, 0.0, 0.0};
  const CellAnalysis cell = analyze_runs(study, 40);
  const double mse = 0.25 + 0.04 + 0.09;  // bias squared and both variances
  EXPECT_NEAR(cell.over_runs("position_mse").mean, mse,
              5.0 * cell.over_runs("position_mse").standard_error());
  EXPECT_NEAR(cell.over_runs("heading_mse").mean, 0.0025,
              5.0 * cell.over_runs("heading_mse").standard_error());
  EXPECT_GT(cell.over_runs("position_mse").standard_error(), 0.0);
  EXPECT_EQ(cell.verdict.answer, Answer::optimistic);
  EXPECT_NEAR(nees_of(cell, ErrorBlock::heading).mean, 1.0, 0.1);
}

TEST(CellSums, WrapsTheHeading) {
  SyntheticStudy study;  // its heading turns through pi again and again
  const CellAnalysis cell = analyze_runs(study, 10);
  EXPECT_LT(cell.over_runs("heading_rmse").mean, 0.06);
}

TEST(CellSums, KnowsAPairOfRunsByHand) {
  RowSums sums({0.2, 0.4});
  for (const double error : {1.0, 3.0}) {
    RunRows rows;
    rows.truth = {error, 0.0, 0.0, 0.0, error, 0.1};
    rows.spread.mean.assign(6, 0.0);
    rows.cpu_seconds = error;
    sums.add(rows);
  }
  const CellAnalysis cell = sums.result();
  EXPECT_EQ(cell.complete, 2u);
  EXPECT_TRUE(cell.nees.empty());
  EXPECT_EQ(cell.verdict.answer, Answer::untested);
  EXPECT_DOUBLE_EQ(cell.over_runs("position_rmse").mean, 2.0);
  EXPECT_DOUBLE_EQ(cell.over_runs("position_rmse").sd, std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(cell.over_runs("position_rmse").standard_error(), 1.0);
  EXPECT_DOUBLE_EQ(cell.over_runs("position_mse").mean, 5.0);
  EXPECT_DOUBLE_EQ(cell.over_runs("position_error_variance_over_time").mean, 0.0);
  EXPECT_DOUBLE_EQ(cell.over_runs("heading_error").mean, 0.05);
  EXPECT_DOUBLE_EQ(cell.over_time("position_rmse")[1], std::sqrt(5.0));
  EXPECT_DOUBLE_EQ(cell.over_runs("cpu_seconds").mean, 2.0);
}

TEST(CellSums, TellsQuartersOfTheDriveApart) {
  RowSums sums({0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 1.4});
  RunRows rows;
  for (const double error : {1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0})
    rows.truth.insert(rows.truth.end(), {error, 0.0, error / 64.0});
  rows.spread.mean.assign(rows.truth.size(), 0.0);
  sums.add(rows);
  const CellAnalysis cell = sums.result();
  EXPECT_DOUBLE_EQ(cell.over_runs("position_error_median").mean, 8.0);
  EXPECT_DOUBLE_EQ(cell.over_runs("position_error_quarter1").mean, 1.0);
  EXPECT_DOUBLE_EQ(cell.over_runs("position_error_quarter2").mean, 3.0);
  EXPECT_DOUBLE_EQ(cell.over_runs("position_error_quarter3").mean, 12.0);
  EXPECT_DOUBLE_EQ(cell.over_runs("position_error_quarter4").mean, 48.0);
  EXPECT_DOUBLE_EQ(cell.over_runs("heading_error_quarter1").mean, 1.0 / 64.0);
  EXPECT_DOUBLE_EQ(cell.over_runs("heading_error_quarter2").mean, 3.0 / 64.0);
  EXPECT_DOUBLE_EQ(cell.over_runs("heading_error_quarter3").mean, 12.0 / 64.0);
  EXPECT_DOUBLE_EQ(cell.over_runs("heading_error_quarter4").mean, 48.0 / 64.0);
}

TEST(CellSums, LetsTheMixtureLeadAndKeepsTheSpread) {
  const SyntheticStudy study;
  RowSums sums(study.times());
  for (std::uint64_t run = 0; run < 30; ++run) {
    RunRows rows = study.run(run);
    rows.mixture = rows.spread;
    for (double& element : rows.spread.covariance) element *= 0.25;
    sums.add(rows);
  }
  const CellAnalysis cell = sums.result();
  EXPECT_EQ(cell.leading, Moments::mixture);
  EXPECT_EQ(cell.verdict.answer, Answer::consistent);
  EXPECT_NEAR(nees_of(cell, ErrorBlock::pose).mean,
              4.0 * nees_of(cell, ErrorBlock::pose, Moments::mixture).mean, 1e-9);
}

// Run 2 has no scan with a number: the cell has the results of the other runs.
TEST(CellSums, LeavesOutAndCountsARunWithoutAJudgedScan) {
  SyntheticStudy study;
  study.scans = 30;
  RowSums sums(study.times()), without(study.times());
  for (std::uint64_t run = 0; run < 12; ++run) {
    RunRows rows = study.run(run);
    if (run != 2) without.add(rows);
    if (run == 2) std::ranges::fill(rows.spread.covariance, kNaN);
    sums.add(rows);
  }
  const CellAnalysis cell = sums.result(), others = without.result();
  EXPECT_EQ(cell.complete, 12u);
  for (const ErrorBlock block : kErrorBlocks) {
    const NeesResult &found = nees_of(cell, block), &expected = nees_of(others, block);
    EXPECT_EQ(found.series.unjudged_runs, 1u);
    EXPECT_EQ(expected.series.unjudged_runs, 0u);
    EXPECT_EQ(found.average_interval.lower, expected.average_interval.lower);
    EXPECT_EQ(found.average_interval.upper, expected.average_interval.upper);
    EXPECT_EQ(found.mean, expected.mean);
  }
  EXPECT_EQ(cell.verdict.ratio().lower, others.verdict.ratio().lower);
  EXPECT_EQ(cell.verdict.answer, others.verdict.answer);
  StudyAnalysis analysis;
  analysis.cells = {cell};
  analysis.cells[0].label = "kf";
  EXPECT_EQ(cautions(analysis.cells, {}).front(),
            "Runs without a scan that can be judged: kf 1 of 12.");
}

TEST(Tones, AreBadOfWhatIsShownBeyondTheMarginOrFailed) {
  Verdict verdict;
  verdict.answer = Answer::optimistic;
  EXPECT_EQ(tone_of(verdict), Tone::plain) << "slightly optimistic";
  verdict.is_refused = true;
  EXPECT_EQ(tone_of(verdict), Tone::bad);
  verdict.beside.repeated_runs = 1;
  EXPECT_EQ(tone_of(verdict), Tone::plain) << "not tested";
  EXPECT_EQ(tone_of(Answer::consistent), Tone::good);
  EXPECT_EQ(tone_of(Answer::undecided), Tone::plain);
  CellAnalysis cell;
  EXPECT_EQ(tone_of_runs(cell), Tone::plain);
  cell.failures.push_back({.run = 3, .step = 0, .reason = "left the map"});
  EXPECT_EQ(tone_of_runs(cell), Tone::bad);
}

TEST(Cautions, SayHowFewParticlesShowARatioOfTwo) {
  CellAnalysis cell;
  cell.label = "pf";
  cell.particles = 20;
  cell.leading = Moments::corrected;
  NeesResult& nees = cell.nees.emplace_back();
  nees.moments = Moments::corrected;
  nees.series.dimension = 3;
  nees.series.samples = 10;
  const std::array<ScoreTable::Value, 1> ess = {{{"ess", 20.0}}};
  cell.scores.add(ess);
  EXPECT_NEAR(shown_for_twice(cell).value(), 1.789, 2e-3);
  const std::vector<std::string> said = cautions({&cell, 1}, {});
  ASSERT_EQ(said.size(), 1u);
  EXPECT_TRUE(said[0].ends_with("pf 1.79.")) << said[0];
  cell.particles = 40;  // of which 20 are effective
  EXPECT_LT(shown_for_twice(cell).value(), 1.9);
  cell.particles = 20'000;
  cell.scores.add(std::array<ScoreTable::Value, 1>{{{"ess", kNaN}}});
  EXPECT_GT(shown_for_twice(cell).value(), 1.99) << "all count if no effective number is stored";
  EXPECT_TRUE(cautions({&cell, 1}, {}).empty());
  cell.particles = 5;
  EXPECT_FALSE(shown_for_twice(cell).has_value()) << "so few are not judged";
  cell.nees[0].moments = cell.leading = Moments::spread;
  EXPECT_FALSE(shown_for_twice(cell).has_value()) << "a Kalman filter draws nothing";
}

TEST(CellSums, CountsWhatIsSingularOrUnusable) {
  SyntheticStudy study;
  study.scans = 3;
  RowSums sums(study.times());
  for (std::uint64_t run = 0; run < 4; ++run) {
    RunRows rows = study.run(run);
    if (run == 1) {  // the heading is known, and right
      for (const std::size_t element : {2u, 5u, 6u, 7u, 8u}) rows.spread.covariance[element] = 0.0;
      rows.spread.mean[2] = rows.truth[2];
    }
    if (run == 2) rows.spread.covariance[9] = std::numeric_limits<double>::quiet_NaN();
    sums.add(rows);
  }
  const CellAnalysis cell = sums.result();
  const NeesSeries& series = nees_of(cell, ErrorBlock::pose).series;
  EXPECT_EQ(series.samples, 12u);
  EXPECT_EQ(series.lower_rank, 1u);
  EXPECT_EQ(series.unusable, 1u);
  EXPECT_EQ(series.runs, (std::vector<std::uint32_t>{4, 3, 4}));
  EXPECT_DOUBLE_EQ(series.bounds[1].upper, nees_bounds(3, 3, 0.95).upper);
  EXPECT_TRUE(std::isfinite(series.average[1]));
}

TEST(CellSums, SummarisesParticles) {
  RowSums sums({0.2, 0.4});
  RunRows rows;
  rows.truth.assign(6, 0.0);
  rows.spread.mean.assign(6, 0.0);
  rows.ess = {4.0, 2.0};
  rows.resampled = {1, 0};
  rows.ancestor = {0, 1, 2, 3, 0, 0, 0, 1};
  sums.add(rows, 4);
  const CellAnalysis cell = sums.result();
  EXPECT_DOUBLE_EQ(cell.over_runs("ess").mean, 3.0);
  EXPECT_DOUBLE_EQ(cell.over_runs("resampling_rate").mean, 0.5);
  EXPECT_DOUBLE_EQ(cell.over_runs("ancestors_at_start").mean, 3.0);
  EXPECT_DOUBLE_EQ(cell.over_runs("ancestors_at_start_at_the_end").mean, 2.0);
}

TEST(CellSums, SumsAssociationsOverARunAndAveragesOverRuns) {
  RowSums sums({0.2, 0.4});
  RunRows rows;
  rows.truth.assign(6, 0.0);
  rows.spread.mean.assign(6, 0.0);
  sums.add(rows);
  EXPECT_TRUE(std::isnan(sums.result().over_runs("association_correct").mean));
  RowSums counted({0.2, 0.4});
  for (const double wrong : {1.0, 4.0}) {
    rows.association = {{3.0, 2.5}, {wrong, 0.5}, {0.0, 0.0}, {1.0, 0.0}, {0.0, 2.0}};
    counted.add(rows);
  }
  const CellAnalysis cell = counted.result();
  EXPECT_DOUBLE_EQ(cell.over_runs("association_correct").mean, 5.5);
  EXPECT_DOUBLE_EQ(cell.over_runs("association_wrong").mean, 3.0);
  EXPECT_DOUBLE_EQ(cell.over_runs("association_missed").mean, 1.0);
  EXPECT_DOUBLE_EQ(cell.over_runs("association_clutter").mean, 2.0);
  EXPECT_DOUBLE_EQ(cell.scores.column("association_wrong")[1], 4.5);
}

TEST(CellSums, AveragesTheInformationAboutTheUnobservable) {
  RowSums sums({0.2, 0.4});
  RunRows rows;
  rows.truth.assign(6, 0.0);
  rows.spread.mean.assign(6, 0.0);
  for (const double last : {4.0, 6.0}) {
    rows.rotation_information = {1.0, last};
    sums.add(rows);
  }
  const CellAnalysis cell = sums.result();
  EXPECT_DOUBLE_EQ(cell.over_runs("rotation_information").mean, 5.0);
  EXPECT_EQ(cell.over_time("rotation_information"), (std::vector{1.0, 5.0}));
  StudyAnalysis study;
  study.times = {0.2, 0.4};
  study.cells = {cell};
  EXPECT_EQ(reported_table(study, "observability").rows.at(0).at(2), "25.6");  // degrees
  study.cells = {CellAnalysis()};
  EXPECT_TRUE(reported_table(study, "observability").rows.empty());
}

TEST(CellSums, AveragesWhatEvolutionChangesWhereSomethingEvolved) {
  RowSums sums({0.2, 0.4, 0.6});
  RunRows rows;
  rows.truth.assign(9, 0.0);
  rows.spread.mean.assign(9, 0.0);
  for (const double gain : {1.0, 3.0}) {
    rows.evolution = {{0.0, 70.0, 90.0}, {0.0, 6.0, 8.0}, {0.0, gain, gain + 1.0}, {0.0, 0.5, 1.5}};
    sums.add(rows);
  }
  const CellAnalysis cell = sums.result();
  EXPECT_DOUBLE_EQ(cell.over_runs("evolution_evaluations").mean, 80.0);
  EXPECT_DOUBLE_EQ(cell.over_runs("evolution_generations").mean, 7.0);
  EXPECT_DOUBLE_EQ(cell.over_runs("evolution_gain").mean, 2.5);
  EXPECT_DOUBLE_EQ(cell.over_runs("evolution_displacement").mean, 1.0);
  EXPECT_EQ(cell.over_time("evolution_gain"), (std::vector{0.0, 2.0, 3.0}));
  StudyAnalysis study;
  study.times = {0.2, 0.4, 0.6};
  study.cells = {cell};
  EXPECT_EQ(reported_table(study, "evolution").rows.at(0).at(1), "80.0");
  study.cells = {CellAnalysis()};
  EXPECT_TRUE(reported_table(study, "evolution").rows.empty());
}

}  // namespace
}  // namespace montecarta::analysis
