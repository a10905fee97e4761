// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/printed/comparison.hpp"

#include "analysis/metrics/nees_batches.hpp"
#include "analysis/printed/run_samples.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/tables/tables.hpp"
#include "engine/random/stream.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

namespace montecarta::analysis {
namespace {

using testing::HasSubstr;

/// Cells "a", "b" and "late", whose position RMSE is 4, 5 and 5 m on the average, with errors that
/// a and b share: each scatters by 1 m, their difference by 0.1 m.
StudyAnalysis paired_study(std::size_t runs) {
  StudyAnalysis study;
  study.cells.resize(3);
  const char* const labels[] = {"a", "b", "late"};
  for (std::size_t c = 0; c < 3; ++c) study.cells[c].label = labels[c];
  RngStream draw({.seed = 8, .purpose = Draw::test});
  for (std::size_t run = 0; run < runs; ++run) {
    const double common = draw.normal(), own = 0.1 * draw.normal(), other = draw.normal();
    const double rmse[] = {4.0 + common, 5.0 + common + own, 5.0 + other};
    for (std::size_t c = 0; c < 3; ++c) {
      const ScoreTable::Value scores[] = {{"position_rmse", rmse[c]},
                                          {"cpu_seconds", c == 0 ? 0.2 : 0.5}};
      study.cells[c].runs.push_back(run);
      study.cells[c].scores.add(scores);
    }
  }
  return study;
}

void leave_band_at(std::optional<double> time, CellAnalysis& cell) {
  NeesResult pose;
  pose.consistency.verdict = Verdict::optimistic;
  pose.consistency.stays_above_from = time;
  cell.nees = {pose};
}

PrintedValue value_of(const char* cell, const char* metric, const char* printed,
                      std::uint64_t runs = 1) {
  PrintedValue value;
  value.cell = cell;
  value.metric = metric;
  value.printed = printed;
  value.runs = runs;
  return value;
}

PrintedClaim claim_of(const char* metric, const char* left, char relation, const char* right) {
  return {metric, left, relation, right, "Fig. 3"};
}

TEST(Comparison, ANumberAgreesWhereAMeanOfAsManyRunsWouldLie) {
  const StudyAnalysis study = paired_study(400);
  const auto verdict = [&](const char* printed, std::uint64_t runs) {
    return compare(study, value_of("a", "position_rmse", printed, runs)).verdict;
  };
  EXPECT_EQ(verdict("5.5", 1), "agrees");  // 1.5 m off, one run scatters by 1 m
  EXPECT_THAT(verdict("5.5", 30), HasSubstr("differs: 1.4 times smaller"));
  EXPECT_EQ(verdict("4.2", 30), "agrees");  // a mean of 30 scatters by 0.18 m
  EXPECT_THAT(verdict("4.6", 30), HasSubstr("differs"));
  EXPECT_THAT(verdict("1.0", 30), HasSubstr("not reproduced: 4.0 times as large"));
  EXPECT_THAT(verdict("9.5", 30), HasSubstr("not reproduced: 2.4 times smaller"));
}

TEST(Comparison, TheIntervalIsStudentsOfOurMean) {
  const StudyAnalysis study = paired_study(10);
  const ComparedValue compared = compare(study, value_of("a", "position_rmse", "4"));
  const Sample sample = sample_of(&study.cells[0], "position_rmse");
  EXPECT_NEAR(t_quantile(10, 0.95), 2.262157, 1e-6);
  EXPECT_NEAR(compared.interval.upper - compared.measured, 2.262157 * sample.sd / std::sqrt(10.0),
              1e-6);
}

TEST(Comparison, ClaimsAreJudgedByPairedDifferences) {
  const StudyAnalysis study = paired_study(12);
  const auto verdict = [&](const char* left, char relation, const char* right) {
    return compare(study, claim_of("position_rmse", left, relation, right)).verdict;
  };
  EXPECT_EQ(verdict("a", '<', "b"), "holds");
  EXPECT_EQ(verdict("b", '<', "a"), "contradicted");
  EXPECT_EQ(verdict("b", '>', "a"), "holds");
  EXPECT_EQ(verdict("a", '<', "a"), "undecided");
  EXPECT_EQ(verdict("a", '~', "b"), "contradicted");
  EXPECT_EQ(verdict("a", '~', "a"), "holds");
  const auto width = [&](const char* left, const char* right) {
    const Interval i = compare(study, claim_of("position_rmse", left, '<', right)).interval;
    return i.upper - i.lower;
  };
  EXPECT_LT(width("a", "b"), 0.2);
  EXPECT_GT(width("b", "late"), 1.0);  // whose errors are not shared
}

TEST(Comparison, OnlyRunsThatBothCompletedArePaired) {
  StudyAnalysis study = paired_study(12);
  auto& a = study.cells[0];
  const std::vector<double> rmse = a.scores.column("position_rmse");
  a.runs.erase(a.runs.begin() + 2, a.runs.begin() + 6);
  a.scores = {};
  for (const std::uint64_t run : a.runs) {
    a.scores.add(std::vector<ScoreTable::Value>{{"position_rmse", rmse[run]}});
  }
  const ComparedClaim claim = compare(study, claim_of("position_rmse", "a", '<', "b"));
  EXPECT_EQ(claim.runs, 8u);
  EXPECT_NEAR(claim.difference, -1.0, 0.2);
  EXPECT_LT(claim.interval.upper - claim.interval.lower, 0.3);
}

TEST(Comparison, RatiosAreOfMeans) {
  const StudyAnalysis study = paired_study(20);
  PrintedValue cost = value_of("a", "cpu_seconds", "0.40");
  cost.relative_to = "b";
  EXPECT_NEAR(compare(study, cost).measured, 0.4, 1e-12);
  EXPECT_EQ(compare(study, cost).verdict, "agrees");
  PrintedValue rmse = value_of("a", "position_rmse", "0.8");
  rmse.relative_to = "b";
  const ComparedValue compared = compare(study, rmse);
  EXPECT_NEAR(compared.measured, 0.8, 0.1);
  EXPECT_LT(compared.interval.upper - compared.interval.lower, 0.1);  // common errors cancel
}

TEST(Comparison, LeavingTheBandIsOneNumberOfAllRuns) {
  StudyAnalysis study = paired_study(5);
  leave_band_at(75.0, study.cells[0]);
  leave_band_at(std::nullopt, study.cells[1]);
  const auto verdict = [&](const char* cell, const char* printed) {
    return compare(study, value_of(cell, "stays_above_from_pose", printed)).verdict;
  };
  EXPECT_EQ(verdict("a", "80"), "agrees within 20 %");
  EXPECT_THAT(verdict("a", "35"), HasSubstr("not reproduced: 2.1 times as large"));
  EXPECT_EQ(verdict("b", "80"), "not reproduced: never");
  EXPECT_EQ(compare(study, claim_of("stays_above_from_pose", "b", '>', "a")).verdict,
            "holds, without interval");
  EXPECT_EQ(compare(study, claim_of("stays_above_from_pose", "late", '>', "a")).verdict,
            "not measured");
}

/// Ten batches of 20 runs that leave the printed band at `by_printed` [s], and the expected one 5 s
/// later.
void leave_band_in_batches(std::vector<double> by_printed, CellAnalysis& cell) {
  BlockBatches block;
  block.by_printed.stays_above_from = by_printed;
  for (double& time : by_printed) time += 5.0;
  block.by_expected.stays_above_from = by_printed;
  cell.findings.put(NeesBatches{20, {block}});
}

// The time of all 200 runs together is another number than that of 20.
TEST(Comparison, ATimeIsComparedWithThoseOfBatchesOfThePapersSize) {
  StudyAnalysis study = paired_study(200);
  study.printed.runs = 20;
  for (CellAnalysis& cell : study.cells) leave_band_at(1.0, cell);
  leave_band_in_batches({70, 75, 80, 82, 84, 86, 90, 95, 99, 120}, study.cells[0]);
  leave_band_in_batches({30, 35, 40, 42, 44, 46, 50, HUGE_VAL, HUGE_VAL, 99}, study.cells[1]);
  const auto compared = [&](const char* cell, const char* printed, std::uint64_t runs = 0) {
    return compare(study, value_of(cell, "stays_above_from_pose", printed, runs));
  };
  EXPECT_EQ(compared("a", "80").verdict, "agrees");
  EXPECT_EQ(compared("a", "80").measured, 85.0);
  EXPECT_EQ(in_words(compared("a", "80").batches), "85.0 [70.0, 120]");
  EXPECT_EQ(in_words(compared("a", "80").by_expected), "90.0 [75.0, 125]");
  EXPECT_EQ(compared("a", "35").verdict, "not reproduced: 2.4 times as large");
  EXPECT_EQ(in_words(compared("b", "80").batches), "45.0 [30.0, never], never in 2 of 10");
  EXPECT_EQ(compared("a", "80", 30).measured, 1.0) << "of another number of runs there is none";
  const auto claim = [&](char relation) {
    return compare(study, claim_of("stays_above_from_pose", "a", relation, "b")).verdict;
  };
  EXPECT_EQ(claim('>'), "undecided: holds in 8 of 10 batches, contradicted in 2 of 10");
  leave_band_in_batches(std::vector<double>(10, 3.0), study.cells[1]);
  EXPECT_EQ(claim('>'), "holds in 10 of 10 batches");
  EXPECT_EQ(claim('<'), "contradicted in 10 of 10 batches");
}

TEST(Comparison, MeansOfScoresAreShownInBatchesToo) {
  StudyAnalysis study = paired_study(200);
  study.printed.runs = 20;
  const ComparedValue found = compare(study, value_of("a", "position_rmse", "4.0", 0));
  EXPECT_EQ(found.batches.batches, 10u);
  EXPECT_NEAR(found.batches.median, 4.0, 0.4);
  EXPECT_LT(found.batches.range.upper - found.batches.range.lower, 1.6);
  EXPECT_EQ(found.by_expected.batches, 0u);
}

TEST(Comparison, NothingComparesWhereTheBaselineIsAnotherWorld) {
  StudyAnalysis study = paired_study(400);
  study.printed.values = {value_of("a", "position_rmse", "1.0", 30),
                          value_of("b", "position_rmse", "5.0", 30),
                          value_of("b", "cpu_seconds", "0.5", 30)};
  const auto verdict = [&](std::size_t k) {
    return compare(study, study.printed.values[k]).verdict;
  };
  EXPECT_EQ(verdict(1), "agrees");
  study.printed.baseline = "a";
  EXPECT_THAT(verdict(0), testing::StartsWith("not reproduced: 4.0 times as large"));
  EXPECT_THAT(verdict(1), testing::StartsWith("another world: a: 4.0 times as large"));
  EXPECT_EQ(verdict(2), "agrees") << "of this metric the baseline has no printed number";
}

TEST(Comparison, StandsAtTheEndOfATerminalsTables) {
  StudyAnalysis study = paired_study(30);
  study.times = {0.2};
  std::ostringstream without;
  print_tables(without, study);
  EXPECT_EQ(without.str().find("Printed and measured"), std::string::npos);
  study.printed.source = "A paper";
  study.printed.values = {value_of("a", "position_rmse", "1.0")};
  study.printed.claims = {claim_of("position_rmse", "a", '<', "b")};
  study.printed.assumptions = {"two loops"};
  std::ostringstream with;
  print_tables(with, study);
  EXPECT_THAT(with.str(), HasSubstr("Printed and measured: A paper"));
  EXPECT_THAT(with.str(), HasSubstr("not reproduced: 4"));
  EXPECT_THAT(with.str(), HasSubstr("position RMSE [m]: a < b"));
  EXPECT_THAT(with.str(), HasSubstr("holds"));
  EXPECT_THAT(with.str(), HasSubstr("Assumed: two loops\n"));
}

TEST(Comparison, EveryMetricCanBeSaidInWords) {
  for (const std::string& metric : printed_metrics()) {
    EXPECT_NE(metric_in_words(metric), metric);
  }
}

}  // namespace
}  // namespace montecarta::analysis
