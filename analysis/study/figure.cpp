// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/figure.hpp"

#include "analysis/study/frame.hpp"
#include "engine/text/number_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <tuple>
#include <utility>

namespace montecarta::analysis {
namespace {

constexpr std::array kColours = {"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"};

/// Least and greatest number of a stretch, the earlier one first; NaN where there is none.
std::array<double, 2> extremes(std::span<const double> values) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::array<double, 2> found = {nan, nan};  // least, greatest
  std::array<std::size_t, 2> at = {0, 0};
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i])) continue;
    if (!(values[i] >= found[0])) std::tie(found[0], at[0]) = std::pair(values[i], i);
    if (!(values[i] <= found[1])) std::tie(found[1], at[1]) = std::pair(values[i], i);
  }
  if (at[1] < at[0]) std::swap(found[0], found[1]);
  return found;
}

constexpr std::size_t kBuckets = 240;
// Farthest ends of the axis, relative to the band.
constexpr double kBelowBand = 0.3, kAboveBand = 1e5;
constexpr double kLogarithmicFrom = 30.0, kDecade = 10.0, kRoom = 1.05;

struct Range {
  double least = std::numeric_limits<double>::infinity();
  double greatest = 0.0;
};

/// Range of all positive values of a panel, bands included; limited to the surroundings of the
/// bands if there are any. Without positive values it is a decade from 1.
Range range_of(const Panel& panel) {
  Range range;
  const auto include = [&](double value) {
    if (!std::isfinite(value) || value <= 0.0) return;
    range.least = std::min(range.least, value);
    range.greatest = std::max(range.greatest, value);
  };
  for (const Curve& curve : panel.curves) std::ranges::for_each(curve.values, include);
  range.least = std::max(range.least, panel.least);
  for (const Band& band : panel.bands) {
    range.least = std::clamp(range.least, kBelowBand * band.lower, 0.5 * band.lower);
    range.greatest = std::clamp(range.greatest, band.upper, kAboveBand * band.upper);
  }
  if (!std::isfinite(range.least)) return {1.0, kDecade};
  return range;
}

/// An axis that extends equally far below and above zero.
ChartAxis around_zero(const Panel& panel) {
  double farthest = 0.0;
  for (const Curve& curve : panel.curves) {
    for (const std::vector<double>& values : {curve.values, curve.envelope}) {
      for (const double value : values) {
        if (std::isfinite(value)) farthest = std::max(farthest, std::abs(value));
      }
    }
  }
  for (const Band& band : panel.bands) farthest = std::max({farthest, -band.lower, band.upper});
  const double end = farthest > 0.0 ? kRoom * farthest : 1.0;
  return {false, -end, end};
}

/// The vertical axis of a panel. A logarithmic one has whole decades, or the range itself if there
/// are bands.
ChartAxis axis_of(const Panel& panel) {
  if (panel.scale == Scale::around_zero) return around_zero(panel);
  const Range range = range_of(panel);
  const bool wide = range.greatest > kLogarithmicFrom * range.least;
  if (panel.scale == Scale::percent) return {false, 0.0, 100.0};
  if (panel.scale == Scale::from_zero || (panel.scale == Scale::automatic && !wide)) {
    return {false, 0.0, std::numeric_limits<double>::quiet_NaN()};
  }
  if (!panel.bands.empty()) return {true, range.least, range.greatest};
  const double from = std::floor(std::log10(range.least));
  const double to = std::max(from + 1.0, std::ceil(std::log10(range.greatest)));
  return {true, std::pow(10.0, from), std::pow(10.0, to)};
}

/// The curves of a panel, thinned; an envelope comes after its curve.
Frame thinned(const Panel& panel, const std::vector<double>& places, const std::string& x_label) {
  Frame frame{{{x_label, "1", places}}};
  for (const Curve& curve : panel.curves) {
    frame.columns.push_back({curve.legend, "1", curve.values});
    if (!curve.envelope.empty()) {
      frame.columns.push_back({curve.legend + " envelope", "1", curve.envelope});
    }
  }
  return thin(frame, kBuckets);
}

ChartPanel chart_panel(const Panel& panel, const ChartAxis& axis, const Frame& series) {
  ChartPanel chart{panel.label, axis, series.columns.front().numbers, {}, panel.bands};
  auto next = series.columns.begin() + 1;
  for (const Curve& curve : panel.curves) {
    Curve& drawn = chart.curves.emplace_back(Curve{curve.legend, curve.style, (next++)->numbers});
    if (!curve.envelope.empty()) drawn.envelope = (next++)->numbers;
  }
  return chart;
}

}  // namespace

std::string line_colour(std::size_t i) {
  if (i == kTruthStyle) return "#999999";
  return i == kReferenceStyle ? "black" : kColours[i % kColours.size()];
}

std::size_t line_dashes(std::size_t i) {
  if (i == kTruthStyle) return 1;
  return i == kReferenceStyle ? 2 : 1 + i / kColours.size();
}

Frame thin(const Frame& frame, std::size_t buckets) {
  const std::vector<double>& times = frame.columns.front().numbers;
  if (times.size() <= 2 * buckets) return frame;
  Frame thinned;
  for (const Frame::Column& one : frame.columns) thinned.columns.push_back({one.name, one.units});
  for (std::size_t b = 0; b < buckets; ++b) {
    const std::size_t begin = b * times.size() / buckets;
    const std::size_t end = (b + 1) * times.size() / buckets;
    thinned.columns[0].numbers.push_back(times[begin]);
    thinned.columns[0].numbers.push_back(times[(begin + end) / 2]);
    for (std::size_t c = 1; c < frame.columns.size(); ++c) {
      const std::span<const double> stretch(frame.columns[c].numbers.data() + begin, end - begin);
      for (const double value : extremes(stretch)) thinned.columns[c].numbers.push_back(value);
    }
  }
  return thinned;
}

void add_panels(const std::vector<Panel>& panels, const std::vector<double>& places,
                Figure& figure) {
  if (panels.empty() || panels.front().curves.empty()) return;
  for (const Panel& panel : panels) {
    Frame series = thinned(panel, places, figure.chart.x_label);
    figure.chart.panels.push_back(chart_panel(panel, axis_of(panel), series));
    figure.data.push_back({panel.name + ".csv", std::move(series)});
  }
  figure.chart.x_to = places.back();
}

Figure figure_of(std::string_view name, const Values& values) {
  const std::string key = "figure " + std::string(name);
  const std::vector<std::string> texts = paragraphs(file_of_prose(key), key, values);
  return {std::string(name), texts.front(), texts.size() > 1 ? texts[1] : ""};
}

}  // namespace montecarta::analysis
