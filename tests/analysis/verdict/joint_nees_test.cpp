// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/joint_nees.hpp"

#include "analysis/render/tables/files.hpp"
#include "analysis/run/joint_scores.hpp"
#include "analysis/statistics/nees_bounds.hpp"
#include "analysis/statistics/spread.hpp"
#include "engine/numbers/angle.hpp"
#include "engine/random/stream.hpp"
#include "tests/analysis/reported.hpp"
#include "tests/analysis/synthetic_runs.hpp"
#include "tests/doubles/csv_table.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <cmath>
#include <limits>
#include <vector>

namespace montecarta::analysis {
namespace {

constexpr Eigen::Index kStates = 7;  // two landmarks
const std::vector<Eigen::Vector2d> kJointWorld = {{5, 1}, {2, -3}};
const std::vector<double> kTruth = {9, 9, 9,
                                    1, 2, 3.1};  // of two scans, of which the second counts
const std::vector<std::uint32_t> kJointScans = {1};

Eigen::VectorXd state() {
  Eigen::VectorXd state(kStates);
  state << 1, 2, 3.1, 5, 1, 2, -3;
  return state;
}

/// Pose and landmarks that go together closely.
Eigen::MatrixXd covariance() {
  Eigen::MatrixXd P = Eigen::MatrixXd::Constant(kStates, kStates, 0.09);
  P.diagonal().array() += 0.01;
  return P;
}

JointRows rows_of(const Eigen::VectorXd& mean, const Eigen::MatrixXd& P) {
  return {{mean.data(), mean.data() + mean.size()}, {P.data(), P.data() + P.size()}};
}

JointScore score_of(const Eigen::VectorXd& mean, const Eigen::MatrixXd& P) {
  return joint_scores(rows_of(mean, P), kJointScans, kTruth, kJointWorld).at(0);
}

TEST(JointScores, AreTheSquaredErrorByTheWholeCovariance) {
  Eigen::VectorXd error(kStates);
  error << 0.3, -0.1, 0.2, 0.4, 0.1, -0.2, 0.05;
  const JointScore score = score_of(state() + error, covariance());
  EXPECT_EQ(score.dimension, 7u);
  EXPECT_NEAR(score.nees, error.dot(covariance().inverse() * error), 1e-9);
}

TEST(JointScores, TakeHeadingsByTheShorterWay) {
  Eigen::VectorXd mean = state();
  mean(2) = -3.1;
  const double turn = 2.0 * kPi - 6.2;
  EXPECT_NEAR(score_of(mean, Eigen::MatrixXd::Identity(kStates, kStates)).nees, turn * turn, 1e-12);
}

TEST(JointScores, LeaveOutLandmarksNeverSeen) {
  Eigen::VectorXd mean = state();
  Eigen::MatrixXd P = covariance();
  mean.segment<2>(3).setConstant(kNaN);
  P.middleRows<2>(3).setConstant(kNaN);
  P.middleCols<2>(3).setConstant(kNaN);
  mean(5) += 0.1;
  const JointScore score = score_of(mean, P);
  EXPECT_EQ(score.dimension, 5u);
  Eigen::MatrixXd rest = Eigen::MatrixXd::Constant(5, 5, 0.09);
  rest.diagonal().array() += 0.01;
  EXPECT_NEAR(score.nees, 0.01 * rest.inverse()(3, 3), 1e-9);
}

TEST(JointScores, AreNoNumberWhereThereIsNone) {
  Eigen::MatrixXd P = covariance();
  P(6, 6) = -0.1;
  EXPECT_TRUE(std::isnan(score_of(state(), P).nees));
  P = covariance();
  P(0, 1) = P(1, 0) = 1.0;  // not positive definite
  EXPECT_TRUE(std::isnan(score_of(state(), P).nees));
  P(0, 1) = kNaN;
  EXPECT_TRUE(std::isnan(score_of(state(), P).nees));
  Eigen::VectorXd mean = state();
  mean(0) = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(std::isnan(score_of(mean, covariance()).nees));
}

/// A study of `runs` runs and four rows, errors drawn from `drawn`, judged by `told`.
JointConsistency study_of(std::size_t runs, const Eigen::MatrixXd& drawn,
                          const Eigen::MatrixXd& told, std::uint64_t seed) {
  const Eigen::MatrixXd L = drawn.llt().matrixL();
  JointNeesSums sums(scan_times(4, 5.0));
  for (std::uint64_t run = 0; run < runs; ++run) {
    RngStream draw({.seed = seed, .run = run, .purpose = Draw::test});
    std::vector<JointScore> scores;
    for (int row = 0; row < 4; ++row) {
      Eigen::VectorXd noise(kStates);
      for (double& value : noise) value = draw.normal();
      scores.push_back(score_of(state() + L * noise, told));
    }
    sums.add(scores);
  }
  return sums.result(0.95, true);
}

TEST(JointConsistency, RejectsAConsistentFilterSeldom) {
  int rejected = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const Verdict verdict = study_of(20, covariance(), covariance(), seed).verdict;
    rejected += verdict.find(Family::size)->is_rejected || verdict.find(Family::scan)->is_rejected;
  }
  // 5 % or a little less, and 5 standard errors of 400 studies
  EXPECT_LE(rejected, 400 * 0.05 + 5.0 * std::sqrt(400 * 0.05 * 0.95));
  EXPECT_GE(rejected, 2);
}

TEST(JointConsistency, FindsTheScaleOfACovariance) {
  EXPECT_EQ(study_of(60, 1.3 * covariance(), covariance(), 1).verdict.answer, Answer::optimistic);
  const JointConsistency cautious = study_of(60, 0.7 * covariance(), covariance(), 1);
  EXPECT_EQ(cautious.verdict.answer, Answer::conservative);
  EXPECT_NEAR(cautious.average.back(), 0.7, 0.1);
  EXPECT_THAT(cautious.runs, Each(60u));
  EXPECT_THAT(cautious.dimension, Each(7.0));
}

// The ratio of a run has a deviation of sqrt(2 / 28), so that 1.96 standard errors are log 1.1
// after 30 runs.
TEST(JointConsistency, IsConsistentWhereTheSizeIsShownToBeWithinTheMargin) {
  const JointConsistency few = study_of(20, covariance(), covariance(), 1);
  EXPECT_EQ(few.verdict.answer, Answer::undecided);
  EXPECT_TRUE(few.verdict.more_runs);
  const Eigen::MatrixXd larger = 1.15 * covariance();
  EXPECT_EQ(study_of(2000, covariance(), covariance(), 1).verdict.answer, Answer::consistent);
  EXPECT_EQ(study_of(2000, larger, covariance(), 1).verdict.answer, Answer::optimistic);
}

TEST(JointConsistency, IsInconsistentWhereRowsAreOffInBothDirections) {
  JointNeesSums sums(scan_times(3));
  for (int run = 0; run < 5; ++run) {
    sums.add(std::vector<JointScore>{{7000.0, 10'000}, {13'000.0, 10'000}, {10'000.0, 10'000}});
  }
  const JointConsistency found = sums.result(0.95, true);
  EXPECT_EQ(found.verdict.answer, Answer::inconsistent);
  EXPECT_LT(found.verdict.find(Family::scan)->members[0].simultaneous.upper, 0.75);
}

TEST(JointConsistency, FindsCorrelationsForgotten) {
  const Eigen::MatrixXd alone = covariance().diagonal().asDiagonal();
  EXPECT_EQ(study_of(60, alone, covariance(), 1).verdict.answer, Answer::optimistic)
      << "every part by itself is right";
}

TEST(JointConsistency, HasTheBoundsOfTheSum) {
  const JointConsistency found = study_of(60, covariance(), covariance(), 1);
  const Interval one = nees_bounds(60, 7, 1.0 - 0.05 / 8.0);  // two families, four rows
  EXPECT_NEAR(found.bounds[2].lower, one.lower / 7.0, 1e-12);
  EXPECT_NEAR(found.bounds[2].upper, one.upper / 7.0, 1e-12);
}

TEST(JointConsistency, CountsWhatIsNoNumber) {
  JointNeesSums sums(scan_times(2));
  const std::vector<JointScore> whole = {{7.0, 7}, {5.0, 5}}, part = {{kNaN, 7}, {6.0, 5}};
  sums.add(whole);
  sums.add(part);
  sums.add({});
  const JointConsistency found = sums.result(0.95, true);
  EXPECT_EQ(found.samples, 4u);
  EXPECT_EQ(found.undefined, 1u);
  EXPECT_EQ(found.runs[0], 1u);
  EXPECT_EQ(found.average[0], 1.0);
  EXPECT_EQ(found.average[1], 1.1);
  EXPECT_EQ(nees_per_component(part), 6.0 / 5.0);
  EXPECT_TRUE(std::isnan(nees_per_component({})));
}

TEST(JointConsistency, SaysWhyItIsNotTested) {
  JointNeesSums sums(scan_times(1));
  EXPECT_FALSE(sums.result(0.95, true).stored);
  sums.add(std::vector<JointScore>{{7.0, 7}});
  const JointConsistency found = sums.result(0.95, false);
  EXPECT_FALSE(found.is_judged());
  EXPECT_THAT(found.missing, HasSubstr("which landmark is which"));
}

StudyAnalysis study_of_two() {
  StudyAnalysis study;
  study.joint_times = {5.0, 10.0};
  CellAnalysis judged, without;
  judged.label = "ekf_slam";
  judged.complete = 20;
  JointConsistency joint;
  joint.stored = true;
  joint.average = {0.5, 1.2};
  joint.bounds = {{0.9, 1.1}, {0.95, 1.05}};
  joint.dimension = {7.0, 9.5};
  joint.runs = {20, 19};
  joint.samples = 40;
  joint.undefined = 1;
  FamilyTest size{.family = Family::size, .members = {{.name = "all"}}};
  size.members[0].estimate = 1.2;
  size.members[0].interval = size.members[0].simultaneous = {1.14, 1.26};
  size.members[0].p = 1e-6;
  joint.verdict.families = {size};
  judge_together(joint.verdict.families, 0.95);
  joint.verdict.answer = joint.verdict.of_tests = Answer::optimistic;
  joint.verdict.is_refused = true;
  judged.findings.put(joint);
  without.label = "fastslam2_m100";
  study.cells = {judged, without};
  return study;
}

TEST(JointTable, HasARowForACellThatWasJudged) {
  const TextTable table = reported_table(study_of_two(), "joint_nees");
  ASSERT_EQ(table.rows.size(), 1u);
  EXPECT_THAT(table.rows[0],
              ElementsAre("ekf_slam", "9.50", "1.20", "[0.950, 1.05]", "0.500 at 5.00 s",
                          "optimistic: NEES 1.14 to 1.26 times too large"));
}

TEST(JointTable, IsFarthestWhereThereIsANumber) {
  StudyAnalysis study = study_of_two();
  JointConsistency joint = study.cells[0].get<JointConsistency>();
  joint.average[0] = std::numeric_limits<double>::quiet_NaN();
  study.cells[0].findings.put(joint);
  EXPECT_EQ(reported_table(study, "joint_nees").rows[0][4], "1.20 at 10.0 s");
}

TEST(JointTable, SaysWhatWasLeftOut) {
  StudyAnalysis study = study_of_two();
  EXPECT_THAT(reported_notes(study, "joint_nees"),
              ElementsAre(HasSubstr("all 2 stored scans"), HasSubstr("1 of 40 joint covariances")));
  study.cells[0].findings.put(JointConsistency{});
  EXPECT_THAT(reported_notes(study, "joint_nees"), IsEmpty());
  EXPECT_THAT(reported_table(study, "joint_nees").rows, IsEmpty());
  EXPECT_THAT(reported_figure(study, "joint_nees").data, IsEmpty());
  JointConsistency unjudged;
  unjudged.missing = "nobody knows";
  study.cells[0].findings.put(unjudged);
  EXPECT_THAT(reported_notes(study, "joint_nees"),
              ElementsAre(HasSubstr("ekf_slam: pose and map together are not")));
}

TEST(JointTable, HasEveryNumberAsCsv) {
  const ScratchFolder folder;
  write_csv(study_of_two(), folder.path());
  auto rows = read_csv(folder / "joint_nees.csv");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[1]["nees_per_component"], "1.2");
  EXPECT_EQ(rows[1]["runs"], "19");
}

TEST(JointFigure, ShowsTheCellAndItsBand) {
  const Figure figure = reported_figure(study_of_two(), "joint_nees");
  ASSERT_EQ(figure.data.size(), 1u);
  EXPECT_EQ(figure.data[0].frame.rows(), 2u);
  EXPECT_EQ(figure.data[0].frame.columns.size(), 4u) << "time, the cell, both ends of the band";
}

}  // namespace
}  // namespace montecarta::analysis
