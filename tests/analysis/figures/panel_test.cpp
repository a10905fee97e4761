// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/figures/panel.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace montecarta {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;

Figure drawn(const Panel& panel) {
  Figure figure;
  add_panels({panel}, {0.2, 0.4}, figure);
  return figure;
}

TEST(Panels, KeepTheBandInSightOfACollapsedFilterAndEveryValueInTheNumbers) {
  const Figure figure =
      drawn({"anees", "ANEES", {{"bad", 0, {3.0, 1e30}}}, {{"band", 2.0, 4.0}}, Scale::automatic});
  EXPECT_THAT(figure.script, HasSubstr("set yrange [1:4000]"));
  EXPECT_THAT(figure.script, HasSubstr("set format y '%h'"));
  EXPECT_EQ(figure.data.front().rows.back().back(), 1e30);
}

TEST(Panels, NumberManyDecadesByTheirPowers) {
  const Figure figure =
      drawn({"count", "particles", {{"one", 0, {1.0, 1e6}}}, {}, Scale::logarithmic});
  EXPECT_THAT(figure.script, HasSubstr("set format y '10^{%T}'"));
}

TEST(Panels, DrawABandThatHasNoEndAbove) {
  const double infinite = std::numeric_limits<double>::infinity();
  const Figure figure = drawn(
      {"ratio", "ratio", {{"one", 0, {1.5, 300.0}}}, {{"right", 1.0, infinite}}, Scale::automatic});
  EXPECT_THAT(figure.script, HasSubstr("set yrange [0.5:300]"));
  EXPECT_THAT(figure.script, HasSubstr("\n0,1,1e+100\n"));
}

TEST(Panels, DoNotFollowABandWithoutAnEndOnALinearAxis) {
  const double infinite = std::numeric_limits<double>::infinity();
  const Figure figure = drawn(
      {"ratio", "ratio", {{"one", 0, {1.5, 10.0}}}, {{"right", 1.0, infinite}}, Scale::automatic});
  EXPECT_THAT(figure.script, HasSubstr("set yrange [0:10.5]"));
}

TEST(Panels, GrowWithTheirNumberAndNameInOneLegendWhatOnlyALowerPanelHolds) {
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  const Panel upper{"upper", "error", {{"one", 0, {1.0, 2.0}}, {"two", 1, {nothing, nothing}}}, {}};
  const Panel lower{"lower", "error", {{"one", 0, {nothing, nothing}}, {"two", 1, {1.0, 2.0}}}, {}};
  Figure low, high;
  low.height = high.height = 200;
  add_panels({upper}, {0.2, 0.4}, low);
  add_panels({upper, lower, lower, lower}, {0.2, 0.4}, high);
  EXPECT_GE(high.height, low.height + 300);
  // gnuplot leaves the title of a curve without values out.
  EXPECT_THAT(high.script, ContainsRegex("keyentry with lines [^\n]*title 'one'"));
  EXPECT_THAT(high.script, ContainsRegex("keyentry with lines [^\n]*title 'two'"));
}

TEST(Panels, HaveAxesAlsoWhereNothingIsPositive) {
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  const Figure figure =
      drawn({"count", "particles", {{"one", 0, {nothing, 0.0}}}, {}, Scale::logarithmic});
  EXPECT_THAT(figure.script, HasSubstr("set yrange [1:10]"));
}

TEST(Panels, ShowAsMuchBelowZeroAsAbove) {
  const Figure figure = drawn(
      {"r", "correlation", {{"one", 0, {1.0, -4.0}}}, {{"white", -2.0, 2.0}}, Scale::around_zero});
  EXPECT_THAT(figure.script, HasSubstr("set yrange [-4.2:4.2]"));
  EXPECT_DOUBLE_EQ(figure.chart.panels.front().axis.low, -4.2);
}

TEST(Panels, CallTheirCommonAxisAsTheFigureWants) {
  Figure figure;
  figure.chart.x_label = "scans apart";
  add_panels({{"r", "correlation", {{"one", 0, {0.1, -0.4}}}, {}, Scale::around_zero}}, {1, 2},
             figure);
  EXPECT_THAT(figure.script, HasSubstr("set xlabel 'scans apart'"));
  EXPECT_EQ(figure.data.front().headings.front(), "scans apart");
}

}  // namespace
}  // namespace montecarta
