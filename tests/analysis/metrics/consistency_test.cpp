// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/consistency.hpp"

#include "analysis/data/study_settings.hpp"
#include "analysis/output/number_text.hpp"
#include "analysis/statistics/spread.hpp"
#include "engine/errors.hpp"
#include "tests/analysis/synthetic_runs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {
namespace {

using testing::HasSubstr;

/// A series of 30 runs of three components with these averages.
NeesSeries series_of(const std::vector<double>& averages) {
  NeesSeries series;
  series.dimension = 3;
  series.average = averages;
  series.median = averages;
  series.runs.assign(averages.size(), 30);
  series.trimmed = averages;
  series.bounds.assign(averages.size(), nees_bounds(30, 3, 0.95));
  series.test = {.average_deviate = 2.364, .average_level = 0.975};  // Student's t of 30 runs
  series.whole_run_bounds.assign(averages.size(), nees_bounds(30, 3, 0.9999));
  return series;
}

Consistency judge(const std::vector<double>& averages) {
  return judge(series_of(averages), scan_times(averages.size(), 0.2));
}

TEST(FirstLasting, FindsTheBeginningOfTheFirstLongEnoughStretch) {
  std::vector<bool> above(100, false);
  for (std::size_t s = 10; s < 34; ++s) above[s] = true;  // one short
  for (std::size_t s = 40; s < 80; ++s) above[s] = true;
  EXPECT_EQ(first_lasting(above, 25), 40u);
  EXPECT_EQ(first_lasting(above, 24), 10u);
  EXPECT_EQ(first_lasting(above, 41), std::nullopt);
  EXPECT_EQ(first_lasting(std::vector<bool>(25, true), 25), 0u);
  EXPECT_EQ(first_lasting({}, 25), std::nullopt);
}

TEST(Judge, CountsSharesOfScans) {
  std::vector<double> averages(100, 3.0);
  averages[3] = 5.0;
  averages[50] = averages[51] = 1.0;
  const Consistency result = judge(averages);
  EXPECT_DOUBLE_EQ(result.share_inside, 0.97);
  EXPECT_DOUBLE_EQ(result.share_above, 0.01);
  EXPECT_DOUBLE_EQ(result.share_below, 0.02);
}

TEST(Judge, IsNotMovedByScansOutsideThePointwiseBandAlone) {
  std::vector<double> averages(100, 3.0);
  averages[3] = 4.2;
  for (std::size_t s = 50; s < 80; ++s) averages[s] = 4.0;  // goes together: one piece of chance
  const Consistency result = judge(averages);
  EXPECT_EQ(result.verdict, Verdict::undecided);
  EXPECT_EQ(in_words(result), "undecided: too few runs");
  EXPECT_FALSE(result.stays_above_from.has_value());
}

TEST(Judge, SaysFromWhenToTheEndTheBandForAllScansIsLeft) {
  std::vector<double> averages(100, 3.0);
  for (std::size_t s = 20; s < 45; ++s) averages[s] = 5.2;
  const Consistency back = judge(averages);
  EXPECT_EQ(back.above_from, 4.2);
  EXPECT_FALSE(back.stays_above_from) << "it is inside again at the end";
  for (std::size_t s = 70; s < 100; ++s) averages[s] = 5.2;
  averages[80] = kNaN;  // no run has a value: says nothing
  const Consistency found = judge(averages);
  ASSERT_TRUE(found.stays_above_from);
  EXPECT_DOUBLE_EQ(*found.stays_above_from, 14.2);
  EXPECT_FALSE(found.stays_below_from || found.below_from);
  averages.assign(100, 1.2);
  EXPECT_EQ(judge(averages).stays_below_from, 0.2);
}

TEST(Judge, SaysHowFarOffTheFarthestScanIs) {
  std::vector<double> averages(100, 3.0);
  averages[19] = 5.2;
  averages[20] = 5.4;
  averages[40] = 0.5;  // farther off, but too large goes before too small
  const Consistency found = judge(averages);
  const Interval band = nees_bounds(30, 3, 0.9999);
  ASSERT_TRUE(found.highest && found.lowest);
  EXPECT_DOUBLE_EQ(found.highest->ratio.lower, 5.4 / band.upper);
  EXPECT_DOUBLE_EQ(found.highest->ratio.upper, 5.4 / band.lower);
  EXPECT_DOUBLE_EQ(found.lowest->time, 8.2);
  EXPECT_EQ(in_words(found), "optimistic by " + compact(5.4 / band.upper) + " to " +
                                 compact(5.4 / band.lower) + " at 4.2 s");
}

/// 30 runs whose averages are about `mean`, with this deviation.
NeesSeries runs_about(double mean, double deviation) {
  NeesSeries series = series_of(std::vector<double>(100, mean));
  for (int run = 0; run < 30; ++run) {
    series.run_averages.push_back(mean + (run % 2 == 0 ? deviation : -deviation));
  }
  return series;
}

TEST(Judge, CallsConsistentWhatIsShownToBeWithinTheMargin) {
  const auto times = scan_times(100, 0.2);
  const Consistency within = judge(runs_about(3.06, 0.02), times);
  EXPECT_EQ(within.verdict, Verdict::consistent) << "although 1 is excluded";
  EXPECT_GT(within.ratio.lower, 1.0);
  EXPECT_EQ(in_words(within), "consistent within 1.1");
  EXPECT_EQ(judge(runs_about(3.06, 0.02), times, 1.01).verdict, Verdict::optimistic);
  NeesSeries one_scan_off = runs_about(3.06, 0.02);
  one_scan_off.average[50] = 6.0;
  EXPECT_EQ(judge(one_scan_off, times).verdict, Verdict::optimistic);
  const Consistency wide = judge(runs_about(3.06, 1.2), times);
  EXPECT_EQ(wide.verdict, Verdict::undecided);
  ASSERT_TRUE(wide.more_runs);
  EXPECT_EQ(in_words(wide), "undecided: " + std::to_string(*wide.more_runs) + " more runs decide");
  EXPECT_GT(wide.least_ratios.upper, wide.ratio.upper / wide.ratio.lower / 1.5);
}

// Some runs have fewer scans that are judged: the mean is of what its interval is of.
TEST(Judge, AveragesOverTheRunsThatItsIntervalIsOf) {
  NeesSeries series = runs_about(3.0, 0.2);
  std::ranges::fill(series.average, 4.0);
  const Consistency found = judge(series, scan_times(100, 0.2));
  EXPECT_DOUBLE_EQ(found.mean, 3.0);
  EXPECT_LT(found.ratio.lower, 1.0);
  EXPECT_GT(found.ratio.upper, 1.0);
}

// Three of 30 runs are lost: the gamma's interval would be far too short.
TEST(Judge, TakesTheBootstrapWhereSomeRunsAreLost) {
  NeesSeries series = runs_about(3.0, 0.5);
  for (int run = 0; run < 3; ++run) series.run_averages[static_cast<std::size_t>(run)] = 3000.0;
  std::ranges::fill(series.average, 302.7);
  const Consistency found = judge(series, scan_times(100, 0.2));
  EXPECT_TRUE(found.is_overdispersed);
  EXPECT_EQ(found.verdict, Verdict::optimistic);
  EXPECT_LT(found.ratio.lower, 50.0);
  EXPECT_GT(found.ratio.upper, 200.0);
}

TEST(Judge, TellsOptimisticFromConservative) {
  std::vector<double> averages(100, 3.0);
  averages[7] = 5.2;
  EXPECT_EQ(judge(averages).verdict, Verdict::optimistic);
  averages[7] = 1.2;
  EXPECT_EQ(judge(averages).verdict, Verdict::conservative);
}

TEST(Judge, UsesTheAverageOverTheRunWhereNoScanIsFarOff) {
  const auto times = scan_times(100, 0.2);
  EXPECT_EQ(judge(runs_about(3.4, 0.01), times).verdict, Verdict::optimistic);
  EXPECT_EQ(judge(runs_about(2.7, 0.01), times).verdict, Verdict::conservative);
}

TEST(ExpectedValues, AreThoseOfTheChiSquare) {
  EXPECT_NEAR(expected_median(3), 2.36597, 1e-5);
  EXPECT_NEAR(expected_median(1), 0.45494, 1e-5);
  // By adding up quantiles: scipy.stats.chi2.ppf of (k + 0.5) / n between 0.1 and 0.9.
  EXPECT_NEAR(expected_trimmed(3), 2.64820, 1e-4);
}

TEST(Judge, LeavesOutScansWithoutARun) {
  std::vector<double> averages(60, 9.0);
  averages[20] = averages[40] = kNaN;
  const Consistency result = judge(averages);
  EXPECT_DOUBLE_EQ(result.share_above, 1.0);
  EXPECT_EQ(result.stays_above_from, 0.2);
  EXPECT_DOUBLE_EQ(result.median, 9.0);
}

TEST(Judge, DoesNotJudgeNothing) {
  EXPECT_EQ(judge(std::vector<double>(30, kNaN)).verdict, Verdict::untested);
  EXPECT_EQ(in_words(Consistency{}), "not tested");
}

/// A verdict on the average over the run alone, within 1.2.
Consistency found_by_average(Verdict verdict, const Interval& ratio) {
  Consistency found;
  found.verdict = verdict;
  found.runs = 40;
  found.within = 1.2;
  found.ratio = ratio;
  found.mean = 3.0 * std::sqrt(ratio.lower * ratio.upper);
  found.average_bounds = {found.mean / ratio.upper, found.mean / ratio.lower};
  return found;
}

TEST(Gate, AnswersByVerdictAndTellsTheNumbers) {
  const auto expect_gate = [](const Consistency& found, GateAnswer answer, const char* words) {
    EXPECT_EQ(gate(found).answer, answer) << words;
    EXPECT_THAT(gate(found).why, HasSubstr(words));
  };
  expect_gate(found_by_average(Verdict::consistent, {0.97, 1.08}), GateAnswer::consistent,
              "consistent within 1.2; ANEES 0.970 to 1.08 times the expected one, 40 runs");
  expect_gate(found_by_average(Verdict::optimistic, {1.3, 1.6}), GateAnswer::inconsistent,
              "not consistent, optimistic by 1.30 to 1.60; ANEES");
  expect_gate(found_by_average(Verdict::conservative, {0.5, 0.7}), GateAnswer::inconsistent,
              "not consistent, conservative by");
  // Shown to differ from 1, not by how much: more runs may find it within the margin.
  expect_gate(found_by_average(Verdict::optimistic, {1.02, 1.3}), GateAnswer::inconsistent,
              "not consistent, optimistic by 1.02 to 1.30, though it may lie within 1.2");
  Consistency open = found_by_average(Verdict::undecided, {0.8, 1.3});
  open.more_runs = 130;
  expect_gate(open, GateAnswer::undecided, "undecided: 130 more runs decide; ANEES 0.800 to 1.30");
  expect_gate(found_by_average(Verdict::undecided, {0.0, HUGE_VAL}), GateAnswer::undecided,
              "undecided: too few runs; 40 runs");
  EXPECT_THROW(gate({}), StudyError);
}

TEST(Gate, StopsAFilterThatFailsOrWhoseSamplesAreUnusable) {
  Consistency good = found_by_average(Verdict::consistent, {0.97, 1.08});
  good.failed = 2;
  EXPECT_THAT(gate(good).why, HasSubstr("(2 of 40 runs failed)"));
  EXPECT_EQ(gate(good).answer, GateAnswer::inconsistent);
  EXPECT_EQ(gate(good, {.failed = 1}).answer, GateAnswer::inconsistent);
  EXPECT_EQ(gate(good, {.failed = 2}).answer, GateAnswer::consistent);
  good.failed = 0;
  good.samples = 600;
  good.unusable = 30;
  EXPECT_EQ(gate(good).answer, GateAnswer::inconsistent);
  EXPECT_EQ(gate(good, {.failed = 600, .unusable = 29}).answer, GateAnswer::inconsistent);
  EXPECT_THAT(gate(good, {.unusable = 30}).why, HasSubstr("(30 of 600 samples are unusable)"));
  EXPECT_EQ(gate(good, {.unusable = 30}).answer, GateAnswer::consistent);
  Consistency none;
  none.runs = none.failed = 20;
  EXPECT_EQ(gate(none).answer, GateAnswer::inconsistent);
}

using testing::ElementsAre;
using testing::IsEmpty;

TEST(Margin, IsThatOfTheStudyInTheFile) {
  EXPECT_EQ(margin_in(""), kUsualMargin);
  EXPECT_EQ(margin_in("[study]\nname = a\n[record]\nwithin = 3\n"), kUsualMargin);
  EXPECT_EQ(margin_in("[study]\nname = a\nwithin = 1.25\n[scenario]\n"), 1.25);
}

TEST(Margin, RefusesWhatIsNone) {
  for (const char* text : {"1", "0.9", "nan", "1.2x", "", "1e9"}) {
    EXPECT_THROW(margin_in(std::string("[study]\nwithin = ") + text), StudyError) << text;
  }
}

TEST(Looks, AreTheRoundsOfAStudyThatStopsByVerdict) {
  const std::string text = "[study]\nname = a\nuntil = verdict\n[scenario]\n";
  EXPECT_THAT(looks_in(text, 200), ElementsAre(32, 64, 128, 200));
  EXPECT_THAT(looks_in(text, 20), ElementsAre(20));
}

TEST(Looks, AreNoneOfAnyOtherStudy) {
  EXPECT_THAT(looks_in("", 200), IsEmpty());
  EXPECT_THAT(looks_in("[study]\nuntil = position_rmse < 1\n", 200), IsEmpty());
  EXPECT_THAT(looks_in("[study]\nname = a\n[record]\nuntil = verdict\n", 200), IsEmpty());
}

}  // namespace

}  // namespace montecarta::analysis
