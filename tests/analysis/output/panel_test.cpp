// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/figure.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace montecarta::analysis {
namespace {

Figure drawn(const Panel& panel) {
  Figure figure;
  add_panels({panel}, {0.2, 0.4}, figure);
  return figure;
}

void expect_axis(const Figure& figure, bool logarithmic, double low, double high) {
  const ChartAxis& axis = figure.chart.panels.front().axis;
  EXPECT_EQ(axis.logarithmic, logarithmic);
  EXPECT_DOUBLE_EQ(axis.low, low);
  EXPECT_DOUBLE_EQ(axis.high, high);
}

TEST(Panels, KeepTheBandVisibleForACollapsedFilterAndEveryValueInTheNumbers) {
  const Figure figure =
      drawn({"anees", "ANEES", {{"bad", 0, {3.0, 1e30}}}, {{"band", 2.0, 4.0}}, Scale::automatic});
  expect_axis(figure, true, 1.0, 4000.0);
  EXPECT_EQ(figure.data.front().rows.back().back(), 1e30);
}

TEST(Panels, NumberManyDecadesByTheirPowers) {
  const Figure figure =
      drawn({"count", "particles", {{"one", 0, {1.0, 1e6}}}, {}, Scale::logarithmic});
  expect_axis(figure, true, 1.0, 1e6);
}

TEST(Panels, DrawABandThatHasNoEndAbove) {
  const double infinite = std::numeric_limits<double>::infinity();
  const Figure figure = drawn(
      {"ratio", "ratio", {{"one", 0, {1.5, 300.0}}}, {{"right", 1.0, infinite}}, Scale::automatic});
  expect_axis(figure, true, 0.5, 300.0);
}

TEST(Panels, DoNotFollowABandWithoutAnEndOnALinearAxis) {
  const double infinite = std::numeric_limits<double>::infinity();
  const Figure figure = drawn(
      {"ratio", "ratio", {{"one", 0, {1.5, 10.0}}}, {{"right", 1.0, infinite}}, Scale::automatic});
  expect_axis(figure, false, 0.0, 10.5);
}

TEST(Panels, HaveAxesAlsoWhereNothingIsPositive) {
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  const Figure figure =
      drawn({"count", "particles", {{"one", 0, {nothing, 0.0}}}, {}, Scale::logarithmic});
  expect_axis(figure, true, 1.0, 10.0);
}

TEST(Panels, ShowAsMuchBelowZeroAsAbove) {
  const Figure figure = drawn(
      {"r", "correlation", {{"one", 0, {1.0, -4.0}}}, {{"white", -2.0, 2.0}}, Scale::around_zero});
  expect_axis(figure, false, -4.2, 4.2);
}

TEST(Panels, CallTheirCommonAxisAsTheFigureWants) {
  Figure figure;
  figure.chart.x_label = "scans apart";
  add_panels({{"r", "correlation", {{"one", 0, {0.1, -0.4}}}, {}, Scale::around_zero}}, {1, 2},
             figure);
  EXPECT_EQ(figure.data.front().headings.front(), "scans apart");
}

}  // namespace
}  // namespace montecarta::analysis
