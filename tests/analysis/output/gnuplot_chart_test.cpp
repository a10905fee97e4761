// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/figure.hpp"
#include "analysis/output/gnuplot.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace montecarta::analysis {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

Chart two_panels() {
  Chart chart{"time [s]", 0.0, 2.0, {}};
  const double infinite = std::numeric_limits<double>::infinity();
  chart.panels = {{"upper", {true, 1.0, 1e6}, {1.0, 2.0}, {}, {{"right", 1.0, infinite}}},
                  {"lower", {false, 0.0, kNothing}, {1.0, 2.0}, {}, {}}};
  chart.panels[0].curves = {{"one", 0, {1.0, 2.0}}, {"two", 1, {kNothing, kNothing}}};
  chart.panels[1].curves = {{"two", 1, {1.0, 2.0}, {0.5, 1.0}, {1.5, 3.0}}};
  return chart;
}

ChartMarks marks_of(ChartMarks::Shape shape) {
  ChartMarks marks;
  marks.name = "mark";
  marks.shape = shape;
  marks.x = {0.5, kNothing, 1.5};
  marks.y = {1.0, kNothing, 2.0};
  marks.width = marks.height = marks.angle = {0.1, 0.1, 0.1};
  return marks;
}

TEST(GnuplotChart, HasOneLegendOfAllThatAnyPanelHolds) {
  const std::string commands = gnuplot_chart(two_panels(), 900).commands;
  EXPECT_THAT(commands, ContainsRegex("keyentry with lines [^\n]*title 'one'"));
  EXPECT_THAT(commands, ContainsRegex("keyentry with lines [^\n]*title 'two'"));
  EXPECT_THAT(commands, ContainsRegex("keyentry with filledcurves [^\n]*title 'right'"));
  EXPECT_THAT(commands, HasSubstr("set yrange [1:1e+06]"));
  EXPECT_THAT(commands, HasSubstr("set format y '10^{%T}'"));
  EXPECT_THAT(commands, HasSubstr("set yrange [0:3.15"));
  EXPECT_THAT(commands, HasSubstr("set xlabel 'time [s]'"));
}

TEST(GnuplotChart, DrawsABandThatHasNoEndAbove) {
  EXPECT_THAT(gnuplot_chart(two_panels(), 900).numbers, HasSubstr("\n0,1,1e+100\n"));
}

TEST(GnuplotChart, InterruptsALineWhereAPlaceIsMissing) {
  Chart chart{"x [m]", 0.0, 2.0, {}};
  chart.panels = {{"panel", {false, 0.0, 3.0}, {}, {}, {}}};
  chart.panels[0].marks = {marks_of(ChartMarks::Shape::line)};
  EXPECT_THAT(gnuplot_chart(chart, 900).numbers, HasSubstr("\n0.5,1\n\n1.5,2\n"));
}

TEST(GnuplotChart, HasAnAxisWhereNothingIsANumber) {
  Chart chart = two_panels();
  chart.panels[1].curves = {{"two", 1, {kNothing, kNothing}}};
  EXPECT_THAT(gnuplot_chart(chart, 900).commands, HasSubstr("set yrange [0:1]"));
}

TEST(GnuplotChart, NamesPlacesOfAnAxis) {
  Chart chart = two_panels();
  chart.panels[1].x_names = {"it's", "b"};
  EXPECT_THAT(gnuplot_chart(chart, 900).commands,
              HasSubstr("set xtics nomirror ('it''s' 0, 'b' 1)"));
}

/// Every shape, through gnuplot itself, in both formats.
TEST(GnuplotChart, IsDrawnWhateverItHolds) {
  const ScratchFolder folder;
  using Shape = ChartMarks::Shape;
  Figure figure{"all", "All", "All shapes.", {}, two_panels()};
  for (const Shape shape :
       {Shape::line, Shape::points, Shape::crosses, Shape::ellipses, Shape::boxes}) {
    figure.chart.panels[0].marks.push_back(marks_of(shape));
  }
  figure.chart.panels[0].marks.back().fill = {"#123456", "#000000", "#ffffff"};
  figure.chart.panels[0].marks.back().text = {"a", "b", "it's"};
  figure.chart.panels.push_back({"nothing", {false, 0.0, 1.0}, {}, {}, {}});
  for (const std::size_t columns : {1u, 2u}) {
    figure.chart.columns = columns;
    figure.chart.x_first = columns == 1 ? 1.0 : kNothing;
    figure.chart.is_map = columns == 2;
    draw(figure, folder.path());
    EXPECT_GT(std::filesystem::file_size(folder / "figures/all.svg"), 1000u);
    EXPECT_GT(std::filesystem::file_size(folder / "figures/all.pdf"), 1000u);
  }
}

TEST(PrintLayout, PutsPanelsInRowsBelowTheLegend) {
  Chart chart = two_panels();
  chart.panels.resize(3, chart.panels[1]);
  const PrintLayout column = print_layout(chart, 900.0, 40.0);
  ASSERT_EQ(column.boxes.size(), 3u);
  EXPECT_GE(column.boxes[0].top, 40.0);
  EXPECT_GT(column.boxes[1].top, column.boxes[0].bottom);
  EXPECT_LT(column.boxes[2].bottom, column.height);
  EXPECT_FALSE(column.boxes[1].is_lowest);
  EXPECT_TRUE(column.boxes[2].is_lowest);
  chart.columns = 2;
  chart.aspect = 0.5;
  const PrintLayout grid = print_layout(chart, 900.0, 40.0);
  EXPECT_EQ(grid.boxes[0].top, grid.boxes[1].top);
  EXPECT_GT(grid.boxes[1].left, grid.boxes[0].right);
  EXPECT_LE(grid.boxes[1].right, 900.0);
  EXPECT_TRUE(grid.boxes[1].is_lowest);  // of its column
  const PanelBox& box = grid.boxes[2];
  EXPECT_DOUBLE_EQ(box.bottom - box.top, 0.5 * (box.right - box.left));
}

TEST(PrintLayout, ShowsAChartThatBeginsZoomedWholeAndZoomed) {
  Chart chart = two_panels();
  chart.x_first = 1.5;
  const PrintLayout layout = print_layout(chart, 900.0, 0.0);
  ASSERT_EQ(layout.boxes.size(), 4u);
  EXPECT_EQ(layout.boxes[0].x_from, 0.0);
  EXPECT_EQ(layout.boxes[1].x_from, 1.5);
  EXPECT_EQ(layout.boxes[0].top, layout.boxes[1].top);
}

}  // namespace
}  // namespace montecarta::analysis
