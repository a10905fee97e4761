// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/error_anatomy.hpp"
#include "analysis/metrics/lineages.hpp"
#include "analysis/metrics/mismatch.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "analysis/statistics/spread.hpp"
#include "tests/analysis/reported.hpp"
#include "tests/analysis/studied_result.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <cmath>
#include <string>
#include <vector>

namespace montecarta::analysis {
namespace {

StudyAnalysis study_of(CellAnalysis cell) {
  StudyAnalysis study;
  cell.label = "srcd_m10";
  cell.complete = 30;
  study.cells = {std::move(cell)};
  return study;
}

TEST(ErrorAnatomyTable, SaysHowMuchIsBiasAndWhatFewParticlesCost) {
  CellAnalysis cell;
  ErrorAnatomy anatomy;
  anatomy.mean_bias_share = 0.25;
  cell.findings.put(anatomy);
  EXPECT_EQ(reported_table(study_of(cell), "error_anatomy").rows.at(0).back(), "-");
  LineageSummary lineages;
  lineages.monte_carlo_share = 0.125;
  cell.findings.put(lineages);
  const TextTable table = reported_table(study_of(cell), "error_anatomy");
  EXPECT_THAT(table.rows.at(0), ElementsAre("srcd_m10", "25.0 %", "12.5 %"));
}

class MismatchOfAFile : public ::testing::Test {
 protected:
  const ResultFile& studied(const std::string& cell) {
    write_studied_result(path_, kTinyLoop,
                         {"cells.cell=" + cell, "study.runs=4", "scenario.noise=matched"});
    return file_.emplace(path_);
  }
  ScratchFolder folder_;
  std::filesystem::path path_ = folder_ / "out.h5";
  std::optional<ResultFile> file_;
};

CellAnalysis cell_of(const std::string& family, double motion, double sensor, double anees) {
  CellAnalysis cell;
  cell.mismatch = {motion, sensor, family};
  NeesResult nees;
  nees.series.dimension = 3;
  nees.mean = anees;
  cell.nees.push_back(nees);
  return cell;
}

TEST(MismatchGrids, HoldTheTestOfEveryPairOfFactors) {
  StudyAnalysis study;
  study.cells = {cell_of("a", 2, 1, 6), cell_of("a", 1, 1, 3), cell_of("b", 1, 1, 3),
                 cell_of("a", 1, 0.5, 9), cell_of("b", 2, 1, 3)};
  const auto grids = mismatch_grids(study);
  ASSERT_EQ(grids.size(), 1u) << "b has one factor of the sensor's noise";
  EXPECT_EQ(grids[0].family, "a");
  EXPECT_THAT(grids[0].motion_noise, ElementsAre(1.0, 2.0));
  EXPECT_THAT(grids[0].sensor_noise, ElementsAre(0.5, 1.0));
  EXPECT_EQ(grids[0].anees(0, 0), 3.0);
  EXPECT_EQ(grids[0].anees(0, 1), 1.0);
  EXPECT_EQ(grids[0].anees(1, 1), 2.0);
  EXPECT_TRUE(std::isnan(grids[0].anees(1, 0)));
  const Figure figure = reported_figure(study, "mismatch");
  ASSERT_EQ(figure.data.size(), 1u);
  const auto& columns = figure.data[0].frame.columns;
  EXPECT_THAT(columns.at(2).numbers, ElementsAre(3.0, 1.0, 2.0));
  EXPECT_THAT(columns.at(5).numbers, ElementsAre(std::log10(3.0), 0.0, std::log10(2.0)));
  const ChartMarks& tiles = figure.chart.panels.at(0).marks.at(0);
  EXPECT_EQ(tiles.fill[1], "#f7f7f7") << "1 is white";
  EXPECT_THAT(tiles.facts.at(2).values, ElementsAre(3.0, 1.0, 2.0));
}

TEST(MismatchGrids, LeaveOutWhatWasNotTested) {
  StudyAnalysis study;
  study.cells = {cell_of("a", 2, 1, 6), cell_of("a", 1, 1, 3), cell_of("a", 1, 0.5, 9)};
  study.cells[1].nees[0].mean = kNaN;
  EXPECT_TRUE(std::isnan(mismatch_grids(study).at(0).anees(0, 1)));
}

// Until the first landmark is seen again the covariance is that of the motion alone.
TEST_F(MismatchOfAFile, ScalesWhatTheFilterBelieves) {
  const ResultFile& file = studied("ekf_slam motion_noise=1,2 sensor_noise=1,2");
  ASSERT_EQ(file.cells().size(), 4u);
  std::vector<std::vector<double>> covariance;
  for (const StoredCell& cell : file.cells()) {
    auto& P = covariance.emplace_back(9 * file.times().size());
    file.read(cell, "pose_covariance", 0, std::span(P));
  }
  EXPECT_DOUBLE_EQ(covariance[1][0], covariance[0][0]);
  EXPECT_DOUBLE_EQ(covariance[2][0], 4.0 * covariance[0][0]);
  EXPECT_DOUBLE_EQ(covariance[3][8], 4.0 * covariance[0][8]);
  const std::size_t last = 9 * (file.times().size() - 1);
  EXPECT_GT(covariance[1][last], 1.2 * covariance[0][last]);
}

TEST_F(MismatchOfAFile, IsFoundInTheFileAndTheLabels) {
  const StudyAnalysis study =
      analyze(studied("fastslam1 particles=10 motion_noise=0.5,1 sensor_noise=1,2"));
  ASSERT_EQ(study.cells.size(), 4u);
  EXPECT_EQ(study.cells[1].label, "fastslam1_m10_motion_noise_0p5_sensor_noise_2");
  EXPECT_EQ(study.cells[1].mismatch.motion_noise, 0.5);
  EXPECT_EQ(study.cells[1].mismatch.sensor_noise, 2.0);
  EXPECT_EQ(study.cells[2].label, "fastslam1_m10");
  for (const CellAnalysis& cell : study.cells) EXPECT_EQ(cell.mismatch.family, "fastslam1_m10");
  EXPECT_EQ(mismatch_grids(study).size(), 1u);
}

using MeanSquares = std::vector<double>;  ///< {run} of both errors

/// A study of these filters.
StudyAnalysis study_of_squares(const std::vector<std::pair<std::string, MeanSquares>>& cells) {
  StudyAnalysis study;
  for (const auto& [filter, squares] : cells) {
    CellAnalysis& cell = study.cells.emplace_back();
    cell.label = filter + "_cell";
    cell.filter = filter;
    for (const double square : squares) {
      const double seconds = filter == "smoother" ? 2.0 : 0.5;
      cell.runs.push_back(cell.complete++);
      cell.scores.add(std::vector<ScoreTable::Value>{
          {"position_mse", square}, {"heading_mse", square}, {"cpu_seconds", seconds}});
    }
  }
  return study;
}

std::vector<std::vector<std::string>> smoother_rows(const StudyAnalysis& study) {
  return reported_table(study, "smoother").rows;
}

TEST(AgainstTheSmoother, EfficiencyIsTheRatioOfRootMeanSquaresOfRunsThatBothCompleted) {
  const auto study = study_of_squares({{"ekf_slam", {4.0, 16.0}}, {"smoother", {1.0, 4.0, 900.0}}});
  ASSERT_EQ(smoother_rows(study).size(), 1u);
  EXPECT_THAT(smoother_rows(study)[0],
              ElementsAre("ekf_slam_cell", "0.500", "0.500", "-", "0.250"));
  EXPECT_THAT(reported_notes(study, "smoother"), ElementsAre(HasSubstr("smoother_cell")));
  EXPECT_THAT(smoother_rows(study_of_squares({{"ekf_slam", {1.0}}})), IsEmpty());
  EXPECT_THAT(smoother_rows(study_of_squares({{"smoother", {1.0}}})), IsEmpty());
}

// Half the differences of s / 3 and e / 6 are -0.025 and 0.025 in turn: their standard error is
// 0.014434, Student's t of four runs 3.1824, and sqrt(3 / 6) exp(+-0.045935) the interval.
TEST(AgainstTheSmoother, HasAnIntervalOfRunsPairByPair) {
  const auto study =
      study_of_squares({{"ekf_slam", {6.1, 5.9, 6.1, 5.9}}, {"smoother", {2.9, 3.1, 2.9, 3.1}}});
  EXPECT_EQ(smoother_rows(study)[0][1], "0.707 [0.675, 0.740]");
}

}  // namespace
}  // namespace montecarta::analysis
