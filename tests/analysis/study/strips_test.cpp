// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/strips.hpp"

#include "analysis/render/figures/gnuplot.hpp"
#include "analysis/statistics/spread.hpp"
#include "engine/namespaces.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

namespace montecarta::analysis {
namespace {

constexpr int kGrey = 32, kNone = ChartStrips::kNoLevel;
constexpr Interval kBand = {0.9, 1.08};

/// Strips of these rows over the times 1, 2, ...
Figure strips_of(const std::vector<std::vector<double>>& rows) {
  StripPanel panel{"strips", "ratio", "inside", "mean", {}};
  for (const std::vector<double>& ratios : rows) {
    panel.rows.push_back({"it's_row_" + std::to_string(panel.rows.size()), ratios,
                          std::vector<Interval>(ratios.size(), kBand), "2.34e5"});
  }
  std::vector<double> times(rows.front().size());
  std::iota(times.begin(), times.end(), 1.0);
  Figure figure{"strips", "Strips", "What they say."};
  add_strips({panel}, times, figure);
  return figure;
}

const ChartStrips::Row& first_row(const Figure& figure) {
  return figure.chart.panels.front().strips.rows.front();
}

TEST(StripLevel, IsGreyInsideTheBandAndElseOfALogarithmicScaleWithTwoEnds) {
  for (const double ratio : {0.9, 1.0, 1.08}) EXPECT_EQ(strip_level(ratio, kBand), kGrey) << ratio;
  EXPECT_EQ(strip_colours()[kGrey], "#e9e9e9");
  EXPECT_EQ(strip_colours().size(), kGrey + 1u);
  const std::vector<std::pair<double, int>> levels = {
      {0.0, 0},    {0.05, 0},  {0.11, 0},   {0.8, 7},    {1.09, 8},  {1.4, 9},
      {10.01, 16}, {99.9, 23}, {101.0, 24}, {999.0, 31}, {1e30, 31}, {kNaN, kNone}};
  for (const auto& [ratio, level] : levels) EXPECT_EQ(strip_level(ratio, kBand), level) << ratio;
  EXPECT_EQ(strip_colours()[31], "#67001f");
  EXPECT_EQ(strip_colours()[0], "#053061");
  const std::vector<StripTick>& ticks = strip_ticks();
  EXPECT_EQ(ticks[1].level, 8u) << "where 1 is";
  EXPECT_EQ(ticks[2].text, "10");
  EXPECT_EQ(ticks[2].level, 16u);
}

TEST(Strips, ColourEveryPlaceOfAShortSeriesAroundItsTime) {
  const Figure figure = strips_of({{1.0, 20.0, kNaN, 0.2}});
  EXPECT_THAT(figure.chart.panels.front().x, ElementsAre(0.0, 1.5, 2.5, 3.5));
  EXPECT_EQ(figure.chart.x_to, 4.0);
  EXPECT_THAT(first_row(figure).levels, ElementsAre(kGrey, 18, kNone, 2));
  EXPECT_EQ(figure.data.front().name, "strips.csv");
  EXPECT_EQ(figure.data.front().frame.columns[1].numbers[1], 20.0);
}

/// Also one that is nearer to 1 than a value inside the band beside it.
TEST(Strips, LoseNoExcursionWhenTheyAreThinned) {
  std::vector<double> ratios(2173, 1.0);
  ratios[1000] = 0.91;
  ratios[1001] = 1.09;
  ratios[503] = ratios[1002] = kNaN;  // the last ones of their columns
  ratios[2172] = 0.5;
  const Figure figure = strips_of({ratios});
  const ChartStrips::Row& row = first_row(figure);
  EXPECT_EQ(row.levels.size(), 500u);
  EXPECT_EQ(std::ranges::count(row.ratios, 1.09), 1);
  EXPECT_EQ(std::ranges::count(row.levels, 8), 1);
  EXPECT_EQ(row.ratios.back(), 0.5);
  EXPECT_EQ(std::ranges::count(row.levels, kGrey), 498);
}

TEST(Strips, AreBoxesOfOneColourWithoutGapsBetweenThem) {
  const Figure figure = strips_of({{1.0, 1.0, 20.0, kNaN, 0.2}, {1.0, 1.0, 1.0, 1.0, 1.0}});
  const StripBoxes boxes = strip_boxes(figure.chart.panels.front(), figure.chart.x_to);
  EXPECT_THAT(boxes.y, ElementsAre(0.0, 0.0, 0.0, 1.0));
  EXPECT_THAT(boxes.x, ElementsAre(1.75, 3.0, 4.75, 2.5));
  EXPECT_THAT(boxes.width, ElementsAre(3.5, 1.0, 0.5, 5.0)) << "the first reaches below the second";
  EXPECT_THAT(boxes.colour,
              ElementsAre(0xe9e9e9, std::stoi(strip_colours()[18].substr(1), nullptr, 16),
                          std::stoi(strip_colours()[2].substr(1), nullptr, 16), 0xe9e9e9));
}

TEST(Strips, AreDrawnWithNamesNotesAndKey) {
  const ScratchFolder folder;
  Figure figure = strips_of({{1.0, 20.0, 0.2}, {kNaN, kNaN, kNaN}});
  figure.chart.panels.push_back(figure.chart.panels.front());
  const GnuplotChart drawn = gnuplot_chart(figure.chart, 900);
  EXPECT_THAT(drawn.commands, HasSubstr("set ytics nomirror ('it''s_row_0' 0, 'it''s_row_1' 1)"));
  EXPECT_THAT(drawn.commands, HasSubstr("set label '2.34e5' noenhanced at graph 1,first 1"));
  EXPECT_THAT(drawn.commands, HasSubstr("set label 'times too large' at screen"));
  EXPECT_THAT(drawn.commands, HasSubstr("set label 'mean' noenhanced at graph 1,graph 1 left"));
  EXPECT_THAT(drawn.commands, testing::Not(HasSubstr("keyentry")));
  draw(std::array{&std::as_const(figure)}, folder.path());
  EXPECT_GT(std::filesystem::file_size(folder / "figures/strips.svg"), 1000u);
  EXPECT_GT(std::filesystem::file_size(folder / "figures/strips.pdf"), 1000u);
}

/// Left edge of the grey field of the key, as a share of the width.
double grey_of_key(const Chart& chart) {
  const std::string commands = gnuplot_chart(chart, 900).commands;
  const std::size_t end = commands.find("'#e9e9e9'");
  return std::stod(commands.substr(commands.rfind("from screen ", end) + 12));
}

TEST(Strips, HaveAKeyThatFitsBesideLongNames) {
  Figure figure = strips_of({{1.0, 2.0}});
  const double before = grey_of_key(figure.chart);
  EXPECT_GT(before, 0.5);
  figure.chart.panels.front().strips.rows.front().name = std::string(50, 'n');
  EXPECT_GT(grey_of_key(figure.chart), before);
  EXPECT_LT(grey_of_key(figure.chart), 1.0 - 80.0 / 900.0);
}

TEST(Strips, HaveRoomForTheirNames) {
  Figure figure = strips_of({{1.0, 2.0}});
  const double before = print_layout(figure.chart, 900.0, 42.0).boxes.front().left;
  figure.chart.panels.front().strips.rows.front().name = std::string(40, 'n');
  const PanelBox box = print_layout(figure.chart, 900.0, 42.0).boxes.front();
  EXPECT_GT(box.left, before + 200.0);
  EXPECT_GT(box.left, 40 * 7.0);
  EXPECT_LT(box.right, 900.0 - 40.0);
}

}  // namespace
}  // namespace montecarta::analysis
