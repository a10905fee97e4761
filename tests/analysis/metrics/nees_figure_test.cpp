// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/nees_bounds.hpp"
#include "analysis/study/study_analysis.hpp"
#include "tests/analysis/reported.hpp"

#include <gtest/gtest.h>

namespace montecarta::analysis {
namespace {

/// Cells of three scans, the second of which is 20 times too large; with a pose, a position and a
/// heading.
StudyAnalysis study_with(std::size_t cells) {
  StudyAnalysis study;
  study.times = {1.0, 2.0, 3.0};
  for (std::size_t i = 0; i < cells; ++i) {
    CellAnalysis& cell = study.cells.emplace_back();
    cell.label = "cell_" + std::to_string(i);
    cell.complete = 100;
    for (const ErrorBlock block : kErrorBlocks) {
      NeesResult& nees = cell.nees.emplace_back();
      nees.block = block;
      const std::size_t d = dimension_of(block);
      const auto expected = static_cast<double>(d);
      nees.series.dimension = d;
      nees.series.average = {expected, 20.0 * expected, kNaN};
      nees.series.bounds.assign(3, nees_bounds(100, d, study.level));
      nees.mean = 7.0 * expected;
    }
  }
  return study;
}

TEST(NeesFigure, IsOfCurvesForSixCellsAndOfStripsForSeven) {
  const Figure six = reported_figure(study_with(6), "anees");
  EXPECT_EQ(six.chart.panels.front().curves.size(), 6u);
  EXPECT_TRUE(six.chart.panels.front().strips.rows.empty());
  const Figure seven = reported_figure(study_with(7), "anees");
  EXPECT_TRUE(seven.chart.panels.front().curves.empty());
  EXPECT_EQ(seven.chart.panels.front().strips.rows.size(), 7u);
  EXPECT_EQ(seven.data.front().name, "nees_ratio_pose.csv");
}

TEST(NeesFigure, HasStripsOfTheRatioInTheOrderOfTheCells) {
  const Figure figure = reported_figure(study_with(7), "anees_parts");
  ASSERT_EQ(figure.chart.panels.size(), 2u);
  for (const ChartPanel& panel : figure.chart.panels) {
    const ChartStrips::Row& row = panel.strips.rows[3];
    EXPECT_EQ(row.name, "cell_3");
    EXPECT_EQ(row.note, "7.00");
    EXPECT_DOUBLE_EQ(row.ratios[1], 20.0);
    EXPECT_EQ(row.levels, (std::vector<int>{32, 18, ChartStrips::kNoLevel}));
  }
}

}  // namespace
}  // namespace montecarta::analysis
