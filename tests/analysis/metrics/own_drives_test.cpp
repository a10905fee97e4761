// SPDX-License-Identifier: BSD-3-Clause
// Runs that each met a drive of its own.
#include "analysis/metrics/cell_sums.hpp"
#include "analysis/metrics/drive_consistency.hpp"
#include "analysis/metrics/innovations.hpp"
#include "analysis/metrics/metric.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace montecarta::analysis {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

/// A drive of `fixes` with one error for all of it, whose square is `ratio` times the covariance.
DriveScores lasting_errors(std::size_t fixes, double ratio) {
  DriveScores scores;
  scores.median = 1.0;
  scores.fixes = fixes;
  scores.seconds = static_cast<double>(fixes - 1);
  VectorSeries& errors = scores.errors[0];
  for (int c = 0; c < 3; ++c) errors.emplace_back(fixes, std::sqrt(ratio));
  scores.blocks[0] = correlated_average(errors, 0.95);
  return scores;
}

std::vector<DriveScores> drives_with(double ratio, std::size_t count) {
  std::vector<DriveScores> runs;
  for (std::uint64_t k = 0; k < count; ++k) runs.push_back(lasting_errors(50 + 10 * k, ratio));
  return runs;
}

TEST(OwnDrives, OneIsJudgedAsADrive) {
  const auto runs = drives_with(1.0, 1);
  const DriveConsistency own = judge_own_drives(runs, 0.95, 1.1),
                         one = judge_drive(runs, 0.95, 1.1);
  EXPECT_NEAR(own.mean.leads().ratio.lower, one.mean.leads().ratio.lower, 1e-12);
  EXPECT_NEAR(own.mean.leads().ratio.upper, one.mean.leads().ratio.upper, 1e-12);
  EXPECT_EQ(own.verdict, one.verdict);
}

// Each drive by itself knows one sample, and all together as many as there are drives.
TEST(OwnDrives, ManyFindWhatLastsForAWholeDrive) {
  const auto runs = drives_with(2.5, 20);
  const DriveConsistency own = judge_own_drives(runs, 0.95, 1.1);
  EXPECT_NEAR(own.mean.leads().effective_samples, 20.0, 1e-6);
  EXPECT_EQ(own.verdict, Verdict::optimistic);
  EXPECT_EQ(own.mean.fixes, 20U * 50U + 10U * 190U);
  EXPECT_EQ(judge_drive(runs, 0.95, 1.1).verdict, Verdict::undecided) << "were they one drive";
}

TEST(OwnDrives, SayHowManyWouldDecide) {
  const DriveConsistency right = judge_own_drives(drives_with(1.0, 5), 0.95, 1.5);
  ASSERT_EQ(right.verdict, Verdict::undecided);
  EXPECT_THAT(in_words(right), StartsWith("5 drives cannot tell: it would take "));
  EXPECT_THAT(in_words(right), HasSubstr(" like them"));
}

TEST(OwnDrives, WithoutAJudgedFixAreLeftOut) {
  auto runs = drives_with(1.0, 3);
  const double mean = judge_own_drives(runs, 0.95, 1.1).mean.leads().mean;
  DriveScores none;
  none.in_gaps = 7;
  runs.push_back(none);
  const DriveConsistency found = judge_own_drives(runs, 0.95, 1.1);
  EXPECT_EQ(found.drives, 3U);
  EXPECT_EQ(found.mean.in_gaps, 7U);
  EXPECT_DOUBLE_EQ(found.mean.leads().mean, mean);
  EXPECT_EQ(judge_own_drives({}, 0.95, 1.1).verdict, Verdict::untested);
}

TEST(OwnDrives, HaveNoMeanOverTime) {
  const std::vector<double> scans = {1.0, 2.0}, others = {0.7, 1.4};
  RunCriteria criteria{.times = scans,
                       .references = {},
                       .beacons = {},
                       .map = {},
                       .joint_scans = {},
                       .walks = BandWalks(0)};
  MeasuredRun run;
  run.rows.ess = run.rows.nis = {2.0, 4.0};
  run.rows.nis_dof = {2, 2};
  const auto analysed = [&] {
    CellSums sums(criteria);
    sums.add(run);
    CellAnalysis cell;
    sums.put(cell);
    return cell;
  };
  EXPECT_THAT(analysed().over_time("ess"), ElementsAre(2.0, 4.0));
  EXPECT_THAT(analysed().get<Innovations>().average, ElementsAre(1.0, 2.0));
  criteria.drives = {{scans, {}, {}}, {others, {}, {}}};
  EXPECT_TRUE(analysed().over_time("ess").empty());
  EXPECT_TRUE(analysed().get<Innovations>().average.empty());
  EXPECT_DOUBLE_EQ(analysed().get<Innovations>().mean, 1.5) << "of whole runs there is one";
  EXPECT_TRUE(series_of(analysed()).empty());
}

}  // namespace
}  // namespace montecarta::analysis
