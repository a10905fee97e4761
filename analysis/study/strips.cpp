// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/strips.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <span>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kMostStripColumns = 500;
constexpr int kLevelsPerDecade = 8, kLevelsBelow = kLevelsPerDecade,
              kLevelsAbove = 3 * kLevelsPerDecade;
constexpr int kInsideLevel = kLevelsBelow + kLevelsAbove;
constexpr double kStripThickness = 0.84;  // share of the distance between rows

/// Red, green and blue, from 0 to 255.
using Colour = std::array<int, 3>;

/// ColorBrewer's RdBu, safe for the colour-blind, without its lightest colours: every colour
/// outside the band is darker than the grey inside it, also in a black-and-white print.
constexpr std::array kTooSmall = {Colour{0x05, 0x30, 0x61}, Colour{0x21, 0x66, 0xac},
                                  Colour{0x43, 0x93, 0xc3}, Colour{0x92, 0xc5, 0xde},
                                  Colour{0xc2, 0xdc, 0xec}};
constexpr std::array kTooLarge = {Colour{0xfb, 0xd0, 0xb9}, Colour{0xf4, 0xa5, 0x82},
                                  Colour{0xd6, 0x60, 0x4d}, Colour{0xb2, 0x18, 0x2b},
                                  Colour{0x67, 0x00, 0x1f}};
constexpr const char* kInsideColour = "#e9e9e9";

/// The colour of a palette at `share` of its length, from 0 to 1, as "#0072b2"; it is interpolated
/// linearly.
std::string colour_within(std::span<const Colour> palette, double share) {
  const double place = share * static_cast<double>(palette.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(place), palette.size() - 2);
  Colour colour{};
  for (std::size_t c = 0; c < colour.size(); ++c) {
    colour[c] = static_cast<int>(std::lround(
        std::lerp(palette[low][c], palette[low + 1][c], place - static_cast<double>(low))));
  }
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", colour[0], colour[1], colour[2]);
  return text;
}

bool is_in_band(double ratio, const Interval& band) {
  return ratio >= band.lower && ratio <= band.upper;
}

/// Places that share a column.
struct SameColour {
  std::size_t begin, end;
};

std::vector<SameColour> columns_of(std::size_t places) {
  const std::size_t columns = std::min(places, kMostStripColumns);
  std::vector<SameColour> stretches;
  for (std::size_t c = 0; c < columns; ++c)
    stretches.push_back({c * places / columns, (c + 1) * places / columns});
  return stretches;
}

/// Left edges of the columns: the first is `from`, the others lie midway between two places.
std::vector<double> begins_of(const std::vector<SameColour>& columns,
                              const std::vector<double>& places, double from) {
  std::vector<double> begins = {from};
  for (std::size_t c = 1; c < columns.size(); ++c)
    begins.push_back(std::midpoint(places[columns[c].begin - 1], places[columns[c].begin]));
  return begins;
}

/// The place in a column that decides its colour (add_strips()).
std::size_t deciding_place(const StripRow& row, const SameColour& column) {
  const auto weight = [&](std::size_t k) {
    const double ratio = row.ratios[k];
    return std::pair(!is_in_band(ratio, row.band[k]), std::abs(std::log(ratio)));
  };
  std::size_t found = column.begin;
  for (std::size_t k = column.begin + 1; k < column.end; ++k) {
    if (std::isnan(row.ratios[k])) continue;
    if (std::isnan(row.ratios[found]) || weight(k) > weight(found)) found = k;
  }
  return found;
}

ChartStrips::Row thinned(const StripRow& row, const std::vector<SameColour>& columns) {
  ChartStrips::Row thin{row.name, {}, {}, row.note};
  for (const SameColour& column : columns) {
    const std::size_t k = deciding_place(row, column);
    thin.ratios.push_back(row.ratios[k]);
    thin.levels.push_back(strip_level(row.ratios[k], row.band[k]));
  }
  return thin;
}

}  // namespace

const std::vector<std::string>& strip_colours() {
  static const std::vector<std::string> all = [] {
    std::vector<std::string> colours;
    for (int level = 0; level < kLevelsBelow; ++level)
      colours.push_back(colour_within(kTooSmall, level / (kLevelsBelow - 1.0)));
    for (int level = 0; level < kLevelsAbove; ++level)
      colours.push_back(colour_within(kTooLarge, level / (kLevelsAbove - 1.0)));
    colours.emplace_back(kInsideColour);
    return colours;
  }();
  return all;
}

int strip_level(double ratio, const Interval& band) {
  if (std::isnan(ratio)) return ChartStrips::kNoLevel;
  if (is_in_band(ratio, band)) return kInsideLevel;
  const double level = std::floor(kLevelsPerDecade * std::log10(ratio)) + kLevelsBelow;
  return static_cast<int>(std::clamp(level, 0.0, kInsideLevel - 1.0));
}

const std::vector<StripTick>& strip_ticks() {
  static const std::vector<StripTick> ticks = {{0, "1/10"},
                                               {kLevelsBelow, "1"},
                                               {kLevelsBelow + kLevelsPerDecade, "10"},
                                               {kLevelsBelow + 2 * kLevelsPerDecade, "100"},
                                               {kInsideLevel, "1000"}};
  return ticks;
}

void add_strips(const std::vector<StripPanel>& panels, const std::vector<double>& places,
                Figure& figure) {
  if (panels.empty() || panels.front().rows.empty()) return;
  const std::vector<SameColour> columns = columns_of(places.size());
  for (const StripPanel& panel : panels) {
    const ChartAxis axis{false, static_cast<double>(panel.rows.size()) - 0.5, -0.5};
    ChartPanel& chart = figure.chart.panels.emplace_back(
        ChartPanel{panel.label, axis, begins_of(columns, places, figure.chart.x_from), {}, {}});
    chart.strips = {{}, panel.inside, panel.notes};
    Frame ratios{{{figure.chart.x_label, "1", chart.x}}};
    for (const StripRow& row : panel.rows) {
      chart.strips.rows.push_back(thinned(row, columns));
      ratios.columns.push_back({row.name, "1", chart.strips.rows.back().ratios});
    }
    figure.data.push_back({panel.name + ".csv", std::move(ratios)});
  }
  figure.chart.x_to = places.back();
}

StripBoxes strip_boxes(const ChartPanel& panel, double x_to) {
  StripBoxes boxes;
  const std::size_t columns = panel.x.size();
  const auto begin = [&](std::size_t column) { return column < columns ? panel.x[column] : x_to; };
  for (std::size_t r = 0; r < panel.strips.rows.size(); ++r) {
    const std::vector<int>& levels = panel.strips.rows[r].levels;
    for (std::size_t c = 0; c < columns; ++c) {
      const int level = levels[c];
      if (level == ChartStrips::kNoLevel || (c > 0 && levels[c - 1] == level)) continue;
      // Every box extends below the following boxes, so that no light line separates neighbours.
      std::size_t gap = c;
      while (gap < columns && levels[gap] != ChartStrips::kNoLevel) ++gap;
      const double left = begin(c), right = begin(gap);
      boxes.x.push_back(std::midpoint(left, right));
      boxes.y.push_back(static_cast<double>(r));
      boxes.width.push_back(right - left);
      boxes.height.push_back(kStripThickness);
      const std::string& colour = strip_colours()[static_cast<std::size_t>(level)];
      boxes.colour.push_back(std::stoi(colour.substr(1), nullptr, 16));
    }
  }
  return boxes;
}

}  // namespace montecarta::analysis
