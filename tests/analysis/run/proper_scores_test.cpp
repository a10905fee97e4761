// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/proper_scores.hpp"

#include "analysis/statistics/spread.hpp"
#include "analysis/study/score_table.hpp"
#include "analysis/study/study_analysis.hpp"
#include "tests/analysis/reported.hpp"
#include "tests/analysis/synthetic_runs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace montecarta::analysis {
namespace {

const double kLogTwoPi = std::log(2.0 * std::numbers::pi);

WhitenedPose whitened(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance) {
  WhitenedPose pose;
  whiten_pose(error, covariance, pose);
  return pose;
}

double log_score_of(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance) {
  return log_score(std::vector{whitened(error, covariance)});
}

TEST(LogScore, IsTheNegativeLogarithmOfTheDensityWhereThereIsOne) {
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
  EXPECT_NEAR(log_score_of({0, 0, 0}, one), 1.5 * kLogTwoPi, 1e-14);
  // In one dimension with deviation 2, an error of 2 has log(2 sqrt(2 pi)) + 1 / 2.
  const Eigen::Matrix3d wide = Eigen::Vector3d(4, 1, 1).asDiagonal();
  EXPECT_NEAR(log_score_of({2, 0, 0}, wide), std::log(2.0) + 0.5 + 1.5 * kLogTwoPi, 1e-14);
  Eigen::Matrix3d correlated = one;
  correlated.topLeftCorner<2, 2>() << 2, 1, 1, 2;  // determinant 3
  EXPECT_NEAR(log_score_of({1, 1, 0}, correlated),
              0.5 * std::log(3.0) + 1.0 / 3.0 + 1.5 * kLogTwoPi, 1e-14);
  const Eigen::Matrix3d singular = Eigen::Vector3d(1, 1, 0).asDiagonal();
  const Eigen::Matrix3d indefinite = Eigen::Vector3d(1, 1, -1).asDiagonal();
  const Eigen::Vector3d none = Eigen::Vector3d::Zero();
  EXPECT_NEAR(log_score(std::vector{whitened(none, singular), whitened(none, one),
                                    whitened(none, indefinite)}),
              1.5 * kLogTwoPi, 1e-14);
  EXPECT_TRUE(std::isnan(log_score_of(none, singular)));
  EXPECT_TRUE(std::isnan(log_score({})));
}

TEST(EnergyScore, KnowsTwoParticlesByHand) {
  const std::vector<double> pose = {0, 0, 0.1, 2, 0, 0.2};
  const std::vector<double> equal = {std::log(0.5), std::log(0.5)};
  // Mean distance to the truth 1; two draws differ by 2 in half of all cases: 1 - 1 / 2.
  EXPECT_NEAR(energy_score(pose, equal, {0, 0}), 0.5, 1e-14);
  const std::vector<double> unequal = {std::log(0.75), std::log(0.25)};
  EXPECT_NEAR(energy_score(pose, unequal, {1, 0}), 1.0 - 0.375, 1e-14);
  EXPECT_NEAR(energy_score(std::vector{3.0, 4.0, 0.0}, std::vector{0.0}, {0, 0}), 5.0, 1e-14);
}

MeasuredRun measured(const RunRows& rows, const std::vector<double>& times,
                     std::size_t particles = 0) {
  MeasuredRun run;
  run.rows = rows;
  run.measure(criteria_of_scans(times), particles);
  return run;
}

/// Scores of a filter that reports `factor` times the covariance of its errors.
ProperScores scores_of_a_filter(double factor) {
  const SyntheticStudy study;
  RunRows rows = study.run(0);
  for (double& element : rows.spread.covariance) element *= factor;
  return measured(rows, study.times()).proper;
}

TEST(ProperScores, AreWorseForAWrongCovarianceOfTheSameErrors) {
  const ProperScores right = scores_of_a_filter(1.0);
  for (const double factor : {0.25, 4.0}) {
    const ProperScores wrong = scores_of_a_filter(factor);
    const double expected = 1.5 * (std::log(factor) + 1.0 / factor - 1.0);
    const double standard_error = std::sqrt(1.5 / 400.0) * std::abs(1.0 - 1.0 / factor);
    EXPECT_NEAR(wrong.log_score - right.log_score, expected, 5.0 * standard_error) << factor;
  }
}

/// Two hundred scans of one particle: an error of 1 m at every second scan, of 1000 m before.
RunRows rows_of_a_particle() {
  RunRows rows;
  for (std::size_t s = 0; s < 200; ++s) {
    const double error = s % 2 == 1 ? 1.0 : 1000.0;
    rows.truth.insert(rows.truth.end(), {0.0, 0.0, 0.0});
    rows.spread.mean.insert(rows.spread.mean.end(), {error, 0.0, 0.0});
    rows.particle_pose.insert(rows.particle_pose.end(), {error, 0.0, 0.0});
    rows.log_weight.push_back(0.0);
  }
  return rows;
}

TEST(ProperScores, TakeTheEnergyScoreAtTwentyScans) {
  EXPECT_DOUBLE_EQ(measured(rows_of_a_particle(), scan_times(200), 1).proper.energy_score, 1.0);
}

TEST(ProperScores, AreNaNWithoutCovarianceOrParticles) {
  RunRows rows = rows_of_a_particle();
  rows.particle_pose.clear();
  const std::vector<double> times = scan_times(200);
  for (const std::size_t particles : {0u, 1u}) {
    const MeasuredRun run = measured(rows, times, particles);
    EXPECT_TRUE(std::isnan(find_score("log_score")->of(run)));
    EXPECT_TRUE(std::isnan(find_score("energy_score")->of(run)));
  }
  rows.truth.clear();
  EXPECT_TRUE(std::isnan(measured(rows, times).proper.energy_score));
}

TEST(ProperScores, AreTheTableOfCellsThatHaveACovariance) {
  StudyAnalysis study;
  study.cells.resize(2);
  study.cells[0].label = "right";
  for (const double score : {1.0, 2.0, 9.0})
    study.cells[0].scores.add(std::vector<ScoreTable::Value>{{"log_score", score}});
  const TextTable table = reported_table(study, "proper_scores");
  ASSERT_EQ(table.rows.size(), 1u);
  EXPECT_EQ(table.rows[0], (TableRow{"right", "4.00", "-"}));
}

}  // namespace
}  // namespace montecarta::analysis
