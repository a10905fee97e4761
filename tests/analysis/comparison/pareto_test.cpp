// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/comparison/pareto.hpp"

#include "tests/analysis/comparison/compared_cells.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace montecarta::analysis {
namespace {

using testing::ElementsAre;

TEST(ParetoFront, HoldsWhatNothingBeats) {
  const std::vector<Offer> offers = {{1, 5}, {2, 3}, {2, 4}, {3, 3}, {5, 1}, {0.5, NAN}, {9, 9}};
  EXPECT_THAT(pareto_front(offers), ElementsAre(true, true, false, false, true, false, false));
  const std::vector<Offer> equal = {{1, 1}, {1, 1}};
  EXPECT_THAT(pareto_front(equal), ElementsAre(true, true));
}

StudyAnalysis priced_study() {
  StudyAnalysis study = compared_study(
      {compared_cell("fast", {3.0, 3.0}, 0.1), compared_cell("good", {1.0, 1.0}, 2.0),
       compared_cell("beaten", {4.0, 4.0}, 5.0), compared_cell("failed", {-1, -1}, 1.0)});
  for (std::size_t i = 0; i < 3; ++i) {
    NeesResult nees;
    nees.consistency.verdict = Verdict::optimistic;
    nees.consistency.mean = i == 2 ? 3.0 : 12.0;
    nees.series.dimension = 3;
    study.cells[i].nees = {nees};
  }
  return study;
}

TEST(CellValues, NameTheCellsOnTheFronts) {
  const std::vector<CellValue> values = cell_values(priced_study());
  ASSERT_EQ(values.size(), 3u);  // no complete run, no value
  EXPECT_TRUE(values[0].accurate_for_cost && values[0].consistent_for_cost);
  EXPECT_TRUE(values[1].accurate_for_cost);
  EXPECT_FALSE(values[1].consistent_for_cost);  // as consistent as "fast", and dearer
  EXPECT_FALSE(values[2].accurate_for_cost);
  EXPECT_TRUE(values[2].consistent_for_cost);
  EXPECT_DOUBLE_EQ(values[0].nees_distance, 2.0);
  StudyAnalysis in_space = priced_study();
  in_space.cells[0].nees[0].series.dimension = 6;
  EXPECT_DOUBLE_EQ(cell_values(in_space)[0].nees_distance, 1.0);
  StudyAnalysis without = priced_study();
  without.has_truth = false;
  EXPECT_TRUE(cell_values(without).empty());
}

TEST(ParetoFigure, NamesEveryPoint) {
  const Figure figure = pareto_figure(cell_values(priced_study()));
  ASSERT_EQ(figure.data.size(), 2u);
  EXPECT_EQ(figure.data[0].rows.size(), 3u);
  const auto& marks = figure.chart.panels.at(0).marks;
  const auto named = [](const ChartMarks& point) {
    return point.text == std::vector<std::string>{"beaten"};
  };
  EXPECT_EQ(std::ranges::count_if(marks, named), 1);
  EXPECT_TRUE(pareto_figure({}).data.empty());
}

TEST(ParetoFigure, HasAnAxisWhateverRunsCost) {
  for (const double cost : {5e-324, 1.7e308, std::numeric_limits<double>::infinity()}) {
    CellValue value;
    value.cell = "odd";
    value.cpu_seconds.mean = cost;
    value.position_rmse.mean = 1.0;
    const Figure figure = pareto_figure(std::vector{value, value});
    EXPECT_GT(figure.chart.x_to, figure.chart.x_from) << cost;
    EXPECT_TRUE(std::isfinite(figure.chart.x_to)) << cost;
  }
}

}  // namespace
}  // namespace montecarta::analysis
