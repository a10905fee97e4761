// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/cell_sums.hpp"
#include "analysis/metrics/drive_consistency.hpp"
#include "analysis/metrics/reference_report.hpp"
#include "engine/random/stream.hpp"
#include "tests/analysis/reported.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace montecarta::analysis {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

/// One after the other: arguments of a call have no order.
Eigen::Vector3d three_normals(RngStream& draw) {
  Eigen::Vector3d numbers;
  for (double& number : numbers) number = draw.normal();
  return numbers;
}

/// A drive of ten minutes along x with a scan and a fix a second.
class Drive10 : public ::testing::Test {
 protected:
  Drive10() {
    for (std::size_t s = 0; s < 600; ++s) times_.push_back(static_cast<double>(s + 1));
    RngStream draw({.seed = 8, .purpose = Draw::test});
    for (const double time : times_) {
      reference_.time.push_back(time);
      const Eigen::Vector3d error = three_normals(draw);
      reference_.position.emplace_back(time + error(0), error(1));
      reference_.heading.push_back(0.1 * error(2));
      reference_.covariance.emplace_back(Eigen::Vector3d(1.0, 1.0, 0.01).asDiagonal());
    }
  }

  /// A run whose errors have `ratio` times the covariance 1, 1, 0.01 that it reports, and forget
  /// by `keep` a second.
  RunRows run(double ratio, double keep, std::uint64_t number = 0) const {
    RngStream draw({.seed = 4, .run = number, .purpose = Draw::test});
    RunRows rows;
    Eigen::Vector3d error = three_normals(draw);
    for (const double time : times_) {
      const Eigen::Vector3d e = std::sqrt(ratio) * error;
      rows.spread.mean.insert(rows.spread.mean.end(), {time + e(0), e(1), 0.1 * e(2)});
      rows.spread.covariance.insert(rows.spread.covariance.end(), {1, 0, 0, 0, 1, 0, 0, 0, 0.01});
      error = keep * error + std::sqrt(1.0 - keep * keep) * three_normals(draw);
    }
    return rows;
  }

  DriveScores scores(const RunRows& rows) const {
    const PathAtFixes fixes(reference_, times_, {});
    return drive_scores(fixes, times_, rows, 0, 0.95);
  }
  DriveConsistency judged(const RunRows& rows, double within = kUsualMargin) const {
    const DriveScores one = scores(rows);
    return judge_drive(std::span(&one, 1), 0.95, within);
  }

  std::vector<double> times_;
  ReferencePath reference_{"reference", {}, {}, {}};
};

TEST_F(Drive10, AFilterThatForgetsIsJudgedByTheDrive) {
  EXPECT_THAT(in_words(judged(run(5.0, 0.3))), StartsWith("optimistic by "));
  EXPECT_EQ(in_words(judged(run(1.0, 0.3), 3.0)), "consistent within 3");
  const DriveConsistency right = judged(run(1.0, 0.3));
  EXPECT_THAT(in_words(right), StartsWith("this drive cannot tell: it would need "));
  EXPECT_GT(right.minutes, 10.0);
  EXPECT_GT(right.mean.leads().effective_samples, 300.0);
}

TEST_F(Drive10, AFilterWhoseErrorsLastIsNot) {
  const DriveConsistency found = judged(run(1.0, 1.0 - 1e-9));
  EXPECT_EQ(found.verdict, Verdict::undecided);
  EXPECT_LT(found.mean.leads().ratio.lower, 0.7);
}

TEST_F(Drive10, AConservativeFilterIsFound) {
  reference_.covariance.assign(600, 0.01 * Eigen::Matrix3d::Identity());
  for (std::size_t s = 0; s < 600; ++s) {
    reference_.position[s] = {times_[s], 0.0};
    reference_.heading[s] = 0.0;
  }
  EXPECT_THAT(in_words(judged(run(0.05, 0.3))), StartsWith("conservative by 0."));
}

TEST_F(Drive10, ManyRunsOnOneDriveSayNoMoreThanOne) {
  const DriveScores one = scores(run(1.0, 0.9));
  const std::vector<DriveScores> many(50, one);
  const DriveConsistency of_one = judge_drive(std::span(&one, 1), 0.95, 1.1);
  const DriveConsistency of_many = judge_drive(many, 0.95, 1.1);
  EXPECT_NEAR(of_many.mean.leads().ratio.lower, of_one.mean.leads().ratio.lower, 1e-12);
  EXPECT_NEAR(of_many.mean.leads().ratio.upper, of_one.mean.leads().ratio.upper, 1e-12);
  EXPECT_NEAR(of_many.minutes, of_one.minutes, 1e-9);
}

TEST_F(Drive10, AReferenceThatIsTheEstimateIsRefusedAndOneThatFedItPointedOut) {
  RunRows rows = run(1.0, 0.3);
  for (std::size_t s = 0; s < 600; ++s) {
    rows.spread.mean[3 * s] = reference_.position[s].x();
    rows.spread.mean[3 * s + 1] = reference_.position[s].y();
    rows.spread.mean[3 * s + 2] = reference_.heading[s];
  }
  EXPECT_EQ(in_words(judged(rows)), "refused: the reference is this estimate");
  for (std::size_t s = 0; s < 600; ++s) {
    rows.spread.mean[3 * s] += 0.1 * std::sin(7.0 * static_cast<double>(s));
  }
  EXPECT_TRUE(judged(rows).mean.is_below_reference);
  EXPECT_FALSE(judged(run(1.0, 0.3)).mean.is_below_reference);
}

TEST_F(Drive10, WithoutFixesOrCovarianceIsNotTested) {
  RunRows rows = run(1.0, 0.3);
  rows.spread.covariance.clear();
  EXPECT_EQ(in_words(judged(rows)), "not tested");
  EXPECT_EQ(in_words(judge_drive({}, 0.95, 1.1)), "not tested");
}

TEST_F(Drive10, ItsTableHasARowForACellAndSaysWhatToConsider) {
  reference_.position[0] = {0.0, 0.0};  // where the drive starts
  RunCriteria criteria{.times = times_,
                       .level = 0.95,
                       .references = {},
                       .beacons = {},
                       .map = {},
                       .joint_scans = {},
                       .walks = BandWalks(0)};
  criteria.references.emplace_back(reference_, times_, Pose{});
  criteria.judged_fixes.emplace_back(reference_, times_, Pose{});
  CellSums sums(criteria);
  MeasuredRun measured;
  measured.rows = run(5.0, 0.3);
  measured.rows.path = measured.rows.spread.mean;
  measured.measure(criteria, 0);
  sums.add(measured);
  StudyAnalysis study;
  study.has_truth = false;
  study.times = times_;
  study.references = {{.name = "reference",
                       .times = times_,
                       .has_heading = true,
                       .has_errors = true,
                       .has_start = criteria.judged_fixes[0].has_start()}};
  study.cells.emplace_back();
  study.cells.front().label = "mine";
  study.cells.front().filter = "external";
  sums.put(study.cells.front());
  const TextTable table = reported_table(study, "drive");
  ASSERT_EQ(table.rows.size(), 1U);
  EXPECT_EQ(table.rows[0][0], "mine");
  EXPECT_THAT(table.rows[0][3], StartsWith("optimistic by "));
  EXPECT_EQ(table.rows[0][8], "600");
  const Section section = reported_section(study, "drive");
  const auto* warnings = std::get_if<Section::Table>(&section.blocks.at(1));
  ASSERT_NE(warnings, nullptr);
  ASSERT_EQ(warnings->table.rows.size(), 2U);
  EXPECT_THAT(warnings->table.rows[0][2], HasSubstr("starts at a fix"));
  EXPECT_THAT(warnings->table.rows[1][2], HasSubstr("only its author knows"));
  EXPECT_THAT(no_truth_sentence(study), HasSubstr("take its place"));
  study.references.front().has_errors = false;
  EXPECT_THAT(reported_table(study, "drive").rows, IsEmpty());
  EXPECT_THAT(no_truth_sentence(study), HasSubstr("no verdict"));
}

}  // namespace
}  // namespace montecarta::analysis
