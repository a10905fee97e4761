// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/boxes.hpp"

#include "analysis/render/figures/gnuplot.hpp"
#include "analysis/statistics/spread.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <array>
#include <filesystem>
#include <numeric>
#include <utility>

namespace montecarta::analysis {
namespace {

std::vector<double> from_zero_to(int last) {
  std::vector<double> values(static_cast<std::size_t>(last) + 1);
  std::iota(values.rbegin(), values.rend(), 0.0);  // not sorted
  return values;
}

TEST(FiveNumbers, AreQuantilesBetweenNeighbours) {
  const FiveNumbers box = five_numbers(from_zero_to(10));
  EXPECT_NEAR(box.low, 0.05, 1e-12);
  EXPECT_DOUBLE_EQ(box.lower_quartile, 2.25);
  EXPECT_DOUBLE_EQ(box.median, 5.0);
  EXPECT_DOUBLE_EQ(box.upper_quartile, 7.75);
  EXPECT_NEAR(box.high, 9.95, 1e-12);
  EXPECT_EQ(five_numbers({3.0}).low, 3.0);
  EXPECT_EQ(five_numbers({3.0}).high, 3.0);
}

Figure boxes_of(const std::vector<BoxRow>& rows) {
  Figure figure{"boxes", "Boxes", "Two boxes."};
  add_boxes(rows, "error [m]", figure);
  return figure;
}

TEST(Boxes, HaveARowForEachCellWithValues) {
  const Figure figure =
      boxes_of({{"a", 0, {3.0, 5.0, 7.0}}, {"none", 1, {kNaN}}, {"b", 2, {kNaN, 20.0}}});
  const ChartPanel& panel = figure.chart.panels.at(0);
  EXPECT_THAT(panel.names, testing::ElementsAre("a", "b"));
  EXPECT_EQ(panel.marks.size(), 4U);  // outline and median of each
  EXPECT_THAT(panel.marks[0].facts[2].values, testing::Each(5.0));
  EXPECT_EQ(panel.marks[0].facts[2].label, "median [m]");
  EXPECT_EQ(panel.marks[3].x.front(), 20.0);
  EXPECT_EQ(panel.marks[3].style, 2U);
  EXPECT_FALSE(figure.chart.x_logarithmic);
  EXPECT_DOUBLE_EQ(figure.chart.x_to, 21.0);
  const Frame& numbers = figure.data.at(0).frame;
  EXPECT_EQ(numbers.columns[0].texts[1], "b");
  EXPECT_EQ(numbers.columns[1].numbers[1], 1.0) << "runs with a value";
  EXPECT_EQ(numbers.columns[4].numbers[0], 5.0);
  EXPECT_TRUE(boxes_of({{"none", 1, {kNaN}}}).data.empty());
}

TEST(Boxes, HaveALogarithmicAxisIfTheySpanMuch) {
  EXPECT_TRUE(boxes_of({{"a", 0, {1.0}}, {"b", 1, {50.0}}}).chart.x_logarithmic);
  EXPECT_FALSE(boxes_of({{"a", 0, {0.0}}, {"b", 1, {50.0}}}).chart.x_logarithmic);
}

TEST(Boxes, AreDrawnWithTheirNamesAndNoLegend) {
  const Figure figure = boxes_of({{"a", 0, {1.0}}, {"it's b", 1, {50.0}}});
  const std::string commands = gnuplot_chart(figure.chart, 900).commands;
  EXPECT_THAT(commands, HasSubstr("set ytics nomirror ('a' 0, 'it''s b' 1)"));
  EXPECT_THAT(commands, HasSubstr("set logscale x"));
  EXPECT_THAT(commands, Not(HasSubstr("keyentry")));
  const ScratchFolder folder;
  draw(std::array{&figure}, folder.path());
  EXPECT_GT(std::filesystem::file_size(folder / "figures/boxes.svg"), 1000u);
}

}  // namespace
}  // namespace montecarta::analysis
