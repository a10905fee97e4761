// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/spread.hpp"
#include "analysis/study/study_analysis.hpp"
#include "tests/analysis/reported.hpp"
#include "tests/doubles/matchers.hpp"

#include <cmath>
#include <string>
#include <vector>

namespace montecarta::analysis {
namespace {

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
