// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/render/figures/ancestry_figure.hpp"
#include "analysis/render/figures/path_figure.hpp"
#include "tests/analysis/synthetic_result.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <algorithm>
#include <string>

namespace montecarta::analysis {
namespace {

const FigureData kLandmarks{"landmarks.csv", {{{"x", "m", {1.0}}, {"y", "m", {2.0}}}}};

Bounds bounds_of_test() {
  Bounds bounds;
  bounds.include(-10.0, 0.0);
  bounds.include(30.0, 20.0);
  return bounds;
}

const ChartMarks* find(const ChartPanel& panel, const std::string& name) {
  const auto found = std::ranges::find(panel.marks, name, &ChartMarks::name);
  return found == panel.marks.end() ? nullptr : &*found;
}

TEST(PathChart, TellsTimeAndErrorOfTheEstimateAndHidesItWithItsCell) {
  const DrawnPath drawn{"ekf",
                        4,
                        {"path_ekf.csv",
                         {{{"time", "s", {0.5, 1.0}},
                           {"true x", "m", {0.0, 10.0}},
                           {"true y", "m", {0.0, 5.0}},
                           {"x", "m", {0.0, 13.0}},
                           {"y", "m", {0.0, 9.0}}}}},
                        {},
                        {"map_ekf.csv",
                         {{{"x", "m", {7.0}},
                           {"y", "m", {8.0}},
                           {"major diameter", "m", {2.0}},
                           {"minor diameter", "m", {1.0}},
                           {"angle", "deg", {30.0}}}}}};
  const Chart chart = path_chart({drawn}, kLandmarks, {}, bounds_of_test());
  EXPECT_TRUE(chart.is_map);
  EXPECT_DOUBLE_EQ(chart.aspect, 0.5);
  ASSERT_EQ(chart.panels.size(), 1u);
  const ChartPanel& panel = chart.panels.front();
  EXPECT_EQ(panel.cell, "ekf");
  EXPECT_EQ(panel.axis.low, 0.0);
  EXPECT_EQ(panel.axis.high, 20.0);
  const ChartMarks* estimate = find(panel, "estimate");
  ASSERT_NE(estimate, nullptr);
  EXPECT_EQ(estimate->cell, "ekf");
  EXPECT_THAT(estimate->x, ElementsAre(0.0, 13.0));
  EXPECT_THAT(estimate->facts.at(0).values, ElementsAre(0.5, 1.0));
  EXPECT_THAT(estimate->facts.at(1).values, ElementsAre(0.0, 5.0));
  ASSERT_NE(find(panel, "true path"), nullptr);
  EXPECT_EQ(find(panel, "true path")->cell, "");
  EXPECT_THAT(find(panel, "true path")->y, ElementsAre(0.0, 5.0));
  EXPECT_THAT(find(panel, "landmark of the map")->angle, ElementsAre(30.0));
  EXPECT_EQ(find(panel, "2 sigma of the pose"), nullptr);
  EXPECT_EQ(find(panel, "true landmark")->style, kReferenceStyle);
}

TEST(PathChart, OfARecordedDriveHasFixesAndNoTruth) {
  const DrawnPath drawn{
      "ekf",
      0,
      {"path_ekf.csv", {{{"time", "s", {0.5}}, {"x", "m", {3.0}}, {"y", "m", {4.0}}}}},
      {},
      {}};
  const FigureData fixes{"fixes_gps.csv",
                         {{{"time", "s", {2.0}}, {"x", "m", {5.0}}, {"y", "m", {6.0}}}}};
  const Chart chart = path_chart({drawn}, {}, fixes, bounds_of_test());
  const ChartPanel& panel = chart.panels.front();
  EXPECT_EQ(find(panel, "true path"), nullptr);
  EXPECT_THAT(find(panel, "estimate")->x, ElementsAre(3.0));
  EXPECT_EQ(find(panel, "estimate")->facts.size(), 1u);
  EXPECT_THAT(find(panel, "fix")->y, ElementsAre(6.0));
  EXPECT_THAT(find(panel, "fix")->facts.at(0).values, ElementsAre(2.0));
}

TEST(AncestryFigure, HasATreeForEveryCellThatCompletedTheRun) {
  const ScratchFolder folder;
  write_synthetic_result(folder / "out.h5", 4, 120);
  const ResultFile file(folder / "out.h5");
  const Figure figure = ancestry_figure(file, 0);
  ASSERT_EQ(figure.data.size(), 2u);
  EXPECT_EQ(figure.data[0].name, "ancestry_scripted_m4.csv");
  EXPECT_GE(figure.data[0].frame.rows(), 4u);  // a line a leaf at least
  const auto& columns = figure.data[0].frame.columns;
  for (std::size_t k = 0; k < figure.data[0].frame.rows(); ++k) {
    EXPECT_LE(columns[0].numbers[k], columns[1].numbers[k]);
    EXPECT_LE(columns[1].numbers[k], file.scan_times().back());
  }
  ASSERT_EQ(figure.chart.panels.size(), 2u);
  EXPECT_EQ(figure.chart.panels[1].cell, "scripted_m3");
  EXPECT_EQ(figure.chart.panels[0].marks.at(0).x.size(), 4 * figure.data[0].frame.rows());
  EXPECT_LT(figure.chart.x_first, file.scan_times().back());
  EXPECT_THAT(figure.sentence, HasSubstr("Run 0:"));
  EXPECT_EQ(ancestry_figure(file, 3).data.size(), 1u);  // scripted_m3 failed in run 3
}

TEST(AncestryFigure, IsNotWhereNoAncestryIsStored) {
  const ScratchFolder folder;
  write_synthetic_result(folder / "out.h5", 2, 40, {},
                         [](StudyPlan& plan) { plan.columns.ancestry = false; });
  EXPECT_TRUE(ancestry_figure(ResultFile(folder / "out.h5"), std::nullopt).data.empty());
}

}  // namespace
}  // namespace montecarta::analysis
