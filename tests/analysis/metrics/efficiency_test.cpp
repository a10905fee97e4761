// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/cramer_rao.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "tests/analysis/studied_result.hpp"
#include "tests/analysis/synthetic_result.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace montecarta::analysis {
namespace {

class BoundOfAFile : public ::testing::Test {
 protected:
  StudyAnalysis analyzed(const std::vector<std::string>& overrides) const {
    write_studied_result(path_, kTinyLoop, overrides);
    return analyze(ResultFile(path_));
  }
  ScratchFolder folder_;
  std::filesystem::path path_ = folder_ / "out.h5";
};

const std::vector<std::string> kTinyNoise = {
    "scenario.sigma_speed=0.003",      "scenario.sigma_steer_deg=0.03",
    "scenario.sigma_range=0.001",      "scenario.sigma_bearing_deg=0.01",
    "scenario.noise=measured-control", "study.runs=400"};

// Where noise is so small that all is linear, a Kalman filter is as good as can be. 400 runs know
// the position error to 5 %: one run's mean square scatters by about its own size.
// Mean squares 12.5 of 50, 1 of 16 and 9 of 36.
TEST(Efficiency, IsTheRatioOfRootsByHand) {
  CellAnalysis cell;
  cell.complete = 2;
  const ScoreTable::Value run[] = {
      {"position_mse", 50.0}, {"heading_mse", 16.0}, {"landmark_rms", 6.0}};
  cell.scores.add(run);
  cell.scores.add(run);
  CramerRaoBound bound;
  EXPECT_TRUE(std::isnan(efficiency_of(cell, bound).map));
  bound.map = 3.0;
  EXPECT_TRUE(std::isnan(efficiency_of(cell, bound).map)) << "without a path there is no bound";
  bound.position = {3.0, 4.0};
  bound.heading = {1.0, 1.0};
  const Efficiency found = efficiency_of(cell, bound);
  EXPECT_DOUBLE_EQ(found.position, 0.5);
  EXPECT_DOUBLE_EQ(found.heading, 0.25);
  EXPECT_DOUBLE_EQ(found.map, 0.5);
  bound.is_bound = false;
  EXPECT_TRUE(std::isnan(efficiency_of(cell, bound).position)) << "a reference is no bound";
}

TEST_F(BoundOfAFile, IsAttainedByEkfSlamAtTinyNoise) {
  const StudyAnalysis study = analyzed(kTinyNoise);
  ASSERT_FALSE(study.bound.empty());
  EXPECT_EQ(study.bound.runs, 1u);
  EXPECT_TRUE(study.bound.is_bound);
  const CellAnalysis& cell = study.cells.front();
  const double relative =
      2.5 * cell.over_runs("position_mse").standard_error() / cell.over_runs("position_mse").mean;
  EXPECT_NEAR(cell.get<Efficiency>().position, 1.0, relative);
  EXPECT_NEAR(cell.get<Efficiency>().heading, 1.0, 0.1);
  EXPECT_NEAR(cell.get<Efficiency>().map, 1.0, 0.1);
  EXPECT_NEAR(cell.over_runs("landmark_nees").mean, 2.0,
              5.0 * cell.over_runs("landmark_nees").standard_error());
}

TEST_F(BoundOfAFile, IsTheAverageOverPathsThatDiffer) {
  const StudyAnalysis study = analyzed({"scenario.noise=matched", "study.runs=20"});
  EXPECT_EQ(study.bound.runs, kBoundRuns);
  EXPECT_GT(study.bound.map, 0.0);
  EXPECT_FALSE(study.bound.is_bound);
  EXPECT_TRUE(std::isnan(study.cells.front().get<Efficiency>().position));
  // An average: about what one path has.
  const StudyAnalysis one = analyzed({"scenario.noise=matched", "study.runs=1"});
  EXPECT_NEAR(study.bound.position.back() / one.bound.position.back(), 1.0, 0.5);
}

TEST_F(BoundOfAFile, IsTheSameWithTheTruthAtScansAlone) {
  const StudyAnalysis every = analyzed({"study.runs=1"});
  const StudyAnalysis scans = analyzed({"study.runs=1", "record.rate=scan"});
  ASSERT_EQ(every.bound.position.size(), scans.bound.position.size());
  EXPECT_NEAR(scans.bound.position.back() / every.bound.position.back(), 1.0, 0.02);
}

TEST_F(BoundOfAFile, IsThatOfTheTruthWhateverFiltersBelieve) {
  const StudyAnalysis matched = analyzed({"study.runs=1"});
  const StudyAnalysis wrong = analyzed({"study.runs=1", "belief.sigma_range=3"});
  EXPECT_EQ(matched.bound, wrong.bound);
}

TEST_F(BoundOfAFile, IsMissingWithItsReason) {
  EXPECT_EQ(analyzed({"scenario.sigma_range=0", "belief.sigma_range=0.1"}).bound.missing,
            "the sensor has no noise");
  write_synthetic_result(path_);
  const StudyAnalysis study = analyze(ResultFile(path_));
  EXPECT_TRUE(study.bound.empty());
  EXPECT_NE(study.bound.missing.find("simulated"), std::string::npos);
  EXPECT_TRUE(std::isnan(study.cells.front().get<Efficiency>().position));
}

}  // namespace
}  // namespace montecarta::analysis
