// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/panel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kBuckets = 300;
constexpr double kBelowBand = 0.3, kAboveBand = 1000.0;  // where the axis ends at the latest
constexpr double kLogarithmicFrom = 30.0, kDecade = 10.0, kRoom = 1.05;

struct Range {
  double least = std::numeric_limits<double>::infinity();
  double greatest = 0.0;
};

/// Of all positive values of a panel, bands included; near the bands where there are some. A decade
/// from 1 where there are none.
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
    range.greatest = std::isfinite(band.upper)
                         ? std::clamp(range.greatest, band.upper, kAboveBand * band.upper)
                         : std::max(range.greatest, kDecade * band.lower);
  }
  if (!std::isfinite(range.least)) return {1.0, kDecade};
  return range;
}

/// All that is drawn is near zero, on one side or the other.
ChartAxis around_zero(const Panel& panel) {
  double farthest = 0.0;
  for (const Curve& curve : panel.curves) {
    for (const double value : curve.values) {
      if (std::isfinite(value)) farthest = std::max(farthest, std::abs(value));
    }
  }
  for (const Band& band : panel.bands) farthest = std::max({farthest, -band.lower, band.upper});
  const double end = farthest > 0.0 ? kRoom * farthest : 1.0;
  return {false, -end, end};
}

/// Logarithmic: whole decades, near a band no farther than the range itself.
ChartAxis axis_of(const Panel& panel) {
  if (panel.scale == Scale::around_zero) return around_zero(panel);
  const Range range = range_of(panel);
  const bool wide = range.greatest > kLogarithmicFrom * range.least;
  if (panel.scale == Scale::percent) return {false, 0.0, 100.0};
  if (panel.scale == Scale::from_zero || (panel.scale == Scale::automatic && !wide)) {
    const bool endless =
        std::ranges::any_of(panel.bands, [](const Band& band) { return std::isinf(band.upper); });
    return {false, 0.0,
            endless ? kRoom * range.greatest : std::numeric_limits<double>::quiet_NaN()};
  }
  if (!panel.bands.empty()) return {true, range.least, range.greatest};
  const double from = std::floor(std::log10(range.least));
  const double to = std::max(from + 1.0, std::ceil(std::log10(range.greatest)));
  return {true, std::pow(10.0, from), std::pow(10.0, to)};
}

ThinnedSeries thinned(const Panel& panel, const std::vector<double>& places) {
  std::vector<NamedSeries> series;
  for (const Curve& curve : panel.curves) series.push_back({curve.legend, "1", curve.values});
  return thin(places, series, kBuckets);
}

ChartPanel chart_panel(const Panel& panel, const ChartAxis& axis, const ThinnedSeries& series) {
  ChartPanel chart{panel.label, axis, series.times, {}, panel.bands};
  for (std::size_t i = 0; i < panel.curves.size(); ++i) {
    chart.curves.push_back(
        {panel.curves[i].legend, panel.curves[i].style, series.series[i].values});
  }
  return chart;
}

}  // namespace

void add_panels(const std::vector<Panel>& panels, const std::vector<double>& places,
                Figure& figure) {
  if (panels.empty() || panels.front().curves.empty()) return;
  for (const Panel& panel : panels) {
    const ThinnedSeries series = thinned(panel, places);
    figure.data.push_back(data_of(panel.name + ".csv", figure.chart.x_label, series));
    figure.chart.panels.push_back(chart_panel(panel, axis_of(panel), series));
  }
  figure.chart.x_to = places.back();
}

}  // namespace montecarta::analysis
