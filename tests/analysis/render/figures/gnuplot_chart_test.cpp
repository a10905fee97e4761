// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/render/figures/gnuplot.hpp"
#include "analysis/render/figures/path_figure.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/study/figure.hpp"
#include "analysis/study/frame.hpp"
#include "engine/errors.hpp"
#include "engine/random/stream.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

namespace montecarta::analysis {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

Chart two_panels() {
  Chart chart{"time [s]", 0.0, 2.0, {}};
  const double infinite = std::numeric_limits<double>::infinity();
  chart.panels = {{"upper", {true, 1.0, 1e6}, {1.0, 2.0}, {}, {{"right", 1.0, infinite}}},
                  {"lower", {false, 0.0, kNothing}, {1.0, 2.0}, {}, {}}};
  chart.panels[0].curves = {{"one", 0, {1.0, 2.0}}, {"two", 1, {kNothing, kNothing}}};
  chart.panels[1].curves = {{"two", 1, {1.0, 3.0}}};
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
  EXPECT_THAT(commands, HasSubstr("set yrange [1:1000000]"));
  EXPECT_THAT(commands, HasSubstr("set format y '10^{%T}'"));
  EXPECT_THAT(commands, HasSubstr("set yrange [0:3.15"));
  EXPECT_THAT(commands, HasSubstr("set xlabel 'time [s]'"));
}

TEST(GnuplotChart, DrawsABandThatHasNoEndAboveAndAnEnvelopeAroundZero) {
  EXPECT_THAT(gnuplot_chart(two_panels(), 900).numbers, HasSubstr("\n0,1,1e+100\n"));
  Chart chart = two_panels();
  chart.panels[0].curves[0].envelope = {3.0, 4.0};
  EXPECT_THAT(gnuplot_chart(chart, 900).numbers, HasSubstr("\n1,-3,3\n2,-4,4\n"));
  EXPECT_THAT(gnuplot_chart(chart, 900).commands,
              HasSubstr("with filledcurves linecolor rgb '#0072B2' fillstyle transparent"));
}

TEST(GnuplotChart, InterruptsALineWhereAPlaceIsMissing) {
  Chart chart{"x [m]", 0.0, 2.0, {}};
  chart.panels = {{"panel", {false, 0.0, 3.0}, {}, {}, {}}};
  chart.panels[0].marks = {marks_of(ChartMarks::Shape::line)};
  EXPECT_THAT(gnuplot_chart(chart, 900).numbers, HasSubstr("\n0.5,1\n\n1.5,2\n"));
}

TEST(GnuplotChart, DashesLinesBeyondTheColours) {
  Chart chart{"x [m]", 0.0, 2.0, {}};
  chart.panels = {{"panel", {false, 0.0, 3.0}, {}, {}, {}}};
  chart.panels[0].marks = {marks_of(ChartMarks::Shape::line)};
  chart.panels[0].marks[0].style = 0;
  EXPECT_THAT(gnuplot_chart(chart, 900).commands, HasSubstr("'#0072B2' dashtype 1"));
  chart.panels[0].marks[0].style = 6;
  EXPECT_THAT(gnuplot_chart(chart, 900).commands, HasSubstr("'#0072B2' dashtype 2"));
}

TEST(GnuplotChart, ShowsAnUnderscoreOfALabelAsItIs) {
  Chart chart = two_panels();
  chart.x_label = "motion_noise";
  EXPECT_THAT(gnuplot_chart(chart, 900).commands, HasSubstr("'motion_noise' noenhanced"));
}

TEST(GnuplotChart, HasAnAxisWhereNothingIsANumber) {
  Chart chart = two_panels();
  chart.panels[1].curves = {{"two", 1, {kNothing, kNothing}}};
  EXPECT_THAT(gnuplot_chart(chart, 900).commands, HasSubstr("set yrange [0:1]"));
}

/// Every shape, through gnuplot itself, in both formats.
TEST(GnuplotChart, IsDrawnWhateverItHolds) {
  const ScratchFolder folder;
  using Shape = ChartMarks::Shape;
  Figure figure{"all", "All", "All shapes.", {}, two_panels()};
  for (const Shape shape : {Shape::line, Shape::points, Shape::crosses, Shape::ellipses}) {
    figure.chart.panels[0].marks.push_back(marks_of(shape));
  }
  figure.chart.panels.push_back({"nothing", {false, 0.0, 1.0}, {}, {}, {}});
  for (const std::size_t columns : {1u, 2u}) {
    figure.chart.columns = columns;
    figure.chart.x_first = columns == 1 ? 1.0 : kNothing;
    figure.chart.is_map = columns == 2;
    draw(std::array{&std::as_const(figure)}, folder.path());
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

TEST(PrintLayout, PutsALabelAboveThatIsTooLongBesideItsAxis) {
  Chart chart = two_panels();
  EXPECT_FALSE(print_layout(chart, 900.0, 0.0).boxes[0].has_heading);
  chart.panels[1].label = "runs not lost [%], M = 100";
  const PrintLayout layout = print_layout(chart, 900.0, 0.0);
  EXPECT_TRUE(layout.boxes[0].has_heading);
  EXPECT_GT(layout.boxes[0].top, 13.0);
}

TEST(GnuplotChart, HasRoomForEveryRowOfTheLegend) {
  constexpr double kRow = 22.4;  // [px] that gnuplot leaves for 13 points
  Chart chart = two_panels();
  for (std::size_t i = 0; i < 12; ++i)
    chart.panels[0].curves.push_back({"a_filter_of_a_long_name_" + std::to_string(i), i, {1, 2}});
  const std::size_t few = gnuplot_chart(two_panels(), 900).height;
  const std::size_t many = gnuplot_chart(chart, 900).height;
  EXPECT_GE(static_cast<double>(many - few), 7.0 * kRow);  // 15 entries in two columns
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

TEST(Gnuplot, NamesThePackageWhereItIsMissingAndTellsWhatItSays) {
  const ScratchFolder folder;
  EXPECT_THAT([&] { run_gnuplot(folder.path(), {"a.gp"}, "gnuplot-that-is-nowhere"); },
              testing::ThrowsMessage<StudyError>(HasSubstr("apt-get install gnuplot-nox")));
  write_text(folder / "good.gp", "x = 1\n");
  write_text(folder / "bad.gp", "if (exists('x')) exit\nplot 'nothing_here.csv'\n");
  EXPECT_THAT(
      [&] {
        run_gnuplot(folder.path(), {"good.gp", "bad.gp"});
      },
      testing::ThrowsMessage<RunError>(
          testing::AllOf(HasSubstr("bad.gp"), HasSubstr("No data in plot"))));
}

TEST(Gnuplot, QuotesText) { EXPECT_EQ(gnuplot_quoted("it's\n_m30"), R"('it''s\n_m30')"); }

TEST(TwoSigmaEllipse, LiesAlongTheAxesOfTheCovariance) {
  const Ellipse flat = two_sigma_ellipse(1.0, 2.0, 4.0, 0.0, 1.0);
  EXPECT_DOUBLE_EQ(flat.major, 8.0);
  EXPECT_DOUBLE_EQ(flat.minor, 4.0);
  EXPECT_DOUBLE_EQ(flat.angle, 0.0);
  const Ellipse tilted = two_sigma_ellipse(0.0, 0.0, 2.0, 1.0, 2.0);
  EXPECT_DOUBLE_EQ(tilted.angle, 45.0);
  EXPECT_NEAR(tilted.major, 4.0 * std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(tilted.minor, 4.0, 1e-12);
}

Figure drawn(const Panel& panel) {
  Figure figure;
  add_panels({panel}, {0.2, 0.4}, figure);
  return figure;
}

/// A curve of two values, the bands behind it, and the axis that both get.
struct PanelAxis {
  const char* what;
  std::vector<double> values;
  std::vector<Band> bands;
  Scale scale;
  ChartAxis axis;
};

TEST(Panels, HaveAnAxisThatShowsCurveAndBand) {
  const std::vector<PanelAxis> cases = {
      {"a collapsed filter", {3.0, 1e30}, {{"b", 2.0, 4.0}}, Scale::automatic, {true, 1.0, 4e5}},
      {"many decades", {1.0, 1e6}, {}, Scale::logarithmic, {true, 1.0, 1e6}},
      {"nothing positive", {kNothing, 0.0}, {}, Scale::logarithmic, {true, 1.0, 10.0}},
      {"zero", {1.0, -4.0}, {{"b", -2.0, 2.0}}, Scale::around_zero, {false, -4.2, 4.2}}};
  for (const auto& [what, values, bands, scale, expected] : cases) {
    const Figure figure = drawn({"name", "label", {{"one", 0, values}}, bands, scale});
    const ChartAxis& axis = figure.chart.panels.front().axis;
    EXPECT_EQ(axis.logarithmic, expected.logarithmic) << what;
    EXPECT_DOUBLE_EQ(axis.low, expected.low) << what;
    EXPECT_DOUBLE_EQ(axis.high, expected.high) << what;
    if (std::isnan(values[0])) continue;
    EXPECT_EQ(figure.data.front().frame.columns.back().numbers.back(), values[1]) << what;
  }
}

TEST(Panels, CallTheirCommonAxisAsTheFigureWants) {
  Figure figure;
  figure.chart.x_label = "scans apart";
  add_panels({{"r", "correlation", {{"one", 0, {0.1, -0.4}}}, {}, Scale::around_zero}}, {1, 2},
             figure);
  EXPECT_EQ(figure.data.front().frame.columns.front().name, "scans apart");
}

std::vector<double> counting(std::size_t n) {
  std::vector<double> times(n);
  std::iota(times.begin(), times.end(), 0.0);
  return times;
}

TEST(Thin, LeavesShortSeriesAlone) {
  const auto thinned = thin({{{"t", "s", counting(20)}, {"a", "m", counting(20)}}}, 10);
  EXPECT_EQ(thinned.columns[0].numbers, counting(20));
  EXPECT_EQ(thinned.columns[1].numbers, counting(20));
}

TEST(Thin, KeepsEveryExtremeInItsOrder) {
  RngStream draw({9, 0, 0, 0, Draw::test});
  std::vector<double> values(2173);
  for (double& value : values) value = draw.normal();
  values[777] = 1e6;
  values[1500] = -1e6;
  const auto thinned =
      thin({{{"t", "s", counting(2173)}, {"a", "m", values}, {"b", "m", values}}}, 300);
  const std::vector<double>& times = thinned.columns[0].numbers;
  EXPECT_EQ(times.size(), 600u);
  EXPECT_TRUE(std::ranges::is_sorted(times));
  for (const Frame::Column& one : std::span(thinned.columns).subspan(1)) {
    ASSERT_EQ(one.numbers.size(), 600u);
    const auto top = std::ranges::max_element(one.numbers);
    EXPECT_EQ(*top, 1e6);
    EXPECT_EQ(*std::ranges::min_element(one.numbers), -1e6);
    EXPECT_NEAR(times[static_cast<std::size_t>(top - one.numbers.begin())], 777.0, 8.0);
  }
}

TEST(Thin, KeepsGapsAndNumbersBesideThem) {
  std::vector<double> values(100, kNaN);
  values[7] = 4.0;
  const auto thinned = thin({{{"t", "s", counting(100)}, {"a", "m", values}}}, 10);
  EXPECT_EQ(thinned.columns[1].numbers[0], 4.0);
  EXPECT_EQ(thinned.columns[1].numbers[1], 4.0);
  EXPECT_TRUE(std::isnan(thinned.columns[1].numbers[2]));
}

}  // namespace
}  // namespace montecarta::analysis
