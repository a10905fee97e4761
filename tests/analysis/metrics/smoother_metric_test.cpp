// SPDX-License-Identifier: BSD-3-Clause
#include "tests/analysis/reported.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace montecarta::analysis {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A cell whose runs 0, 1, ... have these mean squares of both errors.
CellAnalysis cell_with_squares(const std::string& filter, const std::vector<double>& mean_squares,
                               double cpu_seconds) {
  CellAnalysis cell;
  cell.label = filter + "_cell";
  cell.filter = filter;
  for (std::size_t k = 0; k < mean_squares.size(); ++k) {
    const ScoreTable::Value scores[] = {{"position_mse", mean_squares[k]},
                                        {"heading_mse", mean_squares[k]},
                                        {"cpu_seconds", cpu_seconds}};
    cell.runs.push_back(k);
    cell.scores.add(scores);
  }
  cell.complete = cell.runs.size();
  return cell;
}

StudyAnalysis study_with_smoother(std::vector<CellAnalysis> cells) {
  StudyAnalysis study;
  study.cells = std::move(cells);
  return study;
}

TEST(AgainstTheSmoother, EfficiencyIsTheRatioOfRootMeanSquares) {
  const StudyAnalysis study = study_with_smoother({cell_with_squares("ekf_slam", {4.0, 16.0}, 0.5),
                                                   cell_with_squares("smoother", {1.0, 4.0}, 2.0)});
  const TextTable table = reported_table(study, "smoother");
  ASSERT_EQ(table.rows.size(), 1u);
  EXPECT_THAT(table.rows[0], ElementsAre("ekf_slam_cell", "0.500", "0.500", "-", "0.250"));
  EXPECT_THAT(reported_notes(study, "smoother"), ElementsAre(HasSubstr("smoother_cell")));
}

// Half the differences of s / 3 and e / 6 are -0.025 and 0.025 in turn: their standard error is
// 0.014434, Student's t of four runs 3.1824, and sqrt(3 / 6) exp(+-0.045935) the interval.
TEST(AgainstTheSmoother, HasAnIntervalOfRunsPairByPair) {
  const StudyAnalysis study =
      study_with_smoother({cell_with_squares("ekf_slam", {6.1, 5.9, 6.1, 5.9}, 1.0),
                           cell_with_squares("smoother", {2.9, 3.1, 2.9, 3.1}, 1.0)});
  EXPECT_EQ(reported_table(study, "smoother").rows[0][1], "0.707 [0.675, 0.740]");
}

TEST(AgainstTheSmoother, ComparesRunsThatBothCompleted) {
  CellAnalysis shorter = cell_with_squares("ekf_slam", {4.0}, 1.0);
  const StudyAnalysis study =
      study_with_smoother({shorter, cell_with_squares("smoother", {1.0, 900.0}, 1.0)});
  EXPECT_EQ(reported_table(study, "smoother").rows[0][1], "0.500");
}

TEST(AgainstTheSmoother, IsNotThereWithoutASmootherOrAnythingBesideIt) {
  EXPECT_THAT(
      reported_table(study_with_smoother({cell_with_squares("ekf_slam", {1.0}, 1.0)}), "smoother")
          .rows,
      IsEmpty());
  EXPECT_THAT(
      reported_table(study_with_smoother({cell_with_squares("smoother", {1.0}, 1.0)}), "smoother")
          .rows,
      IsEmpty());
}

}  // namespace
}  // namespace montecarta::analysis
