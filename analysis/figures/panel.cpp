// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/figures/panel.hpp"

#include "analysis/figures/gnuplot.hpp"
#include "analysis/output/number_text.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace montecarta {
namespace {

constexpr std::size_t kBuckets = 300;
constexpr double kBelowBand = 0.3, kAboveBand = 1000.0;  // where the axis ends at the latest
constexpr double kLogarithmicFrom = 30.0, kDecade = 10.0, kRoom = 1.05;
constexpr double kBeyondAnyAxis = 1e100;        // gnuplot knows no infinity
constexpr std::size_t kAxisPixels = 66;         // below the lowest panel: ticks and label
constexpr std::size_t kLegendRowPixels = 22;    // of a row
constexpr std::size_t kLeastPanelPixels = 170;  // room for the label of its axis

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

std::string axis_script(const std::string& label, const ChartAxis& axis) {
  const bool plain = !axis.logarithmic || (axis.low >= 0.01 && axis.high <= 1e4);
  return "set ylabel " + gnuplot_quoted(label) + " noenhanced offset 1.5,0\n" +
         (axis.logarithmic ? "set" : "unset") + " logscale y\nset format y '" +
         (plain ? "%h" : "10^{%T}") + "'\nset yrange [" + exact_text(axis.low) + ":" +
         (std::isnan(axis.high) ? "*" : exact_text(axis.high)) + "]\n";
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

std::string band_name(const Panel& panel, std::size_t b) {
  return "$" + panel.name + "_band" + std::to_string(b);
}

/// Numbers of the bands, within the script.
std::string bands_of(const Panel& panel, double last) {
  std::string script;
  for (std::size_t b = 0; b < panel.bands.size(); ++b) {
    const auto& [legend, lower, upper] = panel.bands[b];
    const std::string ends =
        "," + exact_text(lower) + "," + exact_text(std::min(upper, kBeyondAnyAxis)) + "\n";
    script += band_name(panel, b) + " << EOD\nplace,lower,upper\n0" + ends + exact_text(last) +
              ends + "EOD\n";
  }
  return script;
}

/// Apart from the curves: one without values in this panel has them in another.
std::string legend_of(const Panel& panel) {
  std::string script;
  for (const Curve& curve : panel.curves) {
    if (curve.legend.empty()) continue;
    script += ", \\\n  keyentry with lines " + line_style(curve.style) + " title " +
              gnuplot_quoted(curve.legend);
  }
  return script;
}

std::string plot_of(const Panel& panel, bool legend) {
  std::string script = "plot ";
  for (std::size_t b = 0; b < panel.bands.size(); ++b) {
    script += band_name(panel, b) +
              " using 1:2:3 with filledcurves fillcolor rgb '#707070' fillstyle transparent solid "
              "0.45 border "
              "linecolor rgb '#666666' linewidth 0.6" +
              (panel.bands[b].legend.empty() || !legend
                   ? " notitle"
                   : " title " + gnuplot_quoted(panel.bands[b].legend)) +
              ", \\\n  ";
  }
  for (std::size_t i = 0; i < panel.curves.size(); ++i) {
    script += (i == 0 ? "'../data/" + panel.name + ".csv'" : "''") +
              " using 1:" + std::to_string(i + 2) + " with lines " +
              line_style(panel.curves[i].style) + " notitle" +
              (i + 1 < panel.curves.size() ? ", \\\n  " : "");
  }
  if (legend) script += legend_of(panel);
  script += "\n";
  return script;
}

/// A legend above all panels; returns its rows.
std::size_t add_legend(const Panel& panel, Figure& figure) {
  std::size_t entries = panel.curves.size(), longest = 8;
  for (const Curve& curve : panel.curves) longest = std::max(longest, curve.legend.size());
  for (const Band& band : panel.bands) {
    longest = std::max(longest, band.legend.size());
    entries += band.legend.empty() ? 0 : 1;
  }
  const std::size_t columns =
      std::clamp<std::size_t>((figure.width - 90) / (8 * longest + 68), 1, entries);
  figure.script += "set key at screen 0.085,0.985 left top horizontal Left reverse maxcols " +
                   std::to_string(columns) + "\n";
  return (entries + columns - 1) / columns;
}

}  // namespace

void add_panels(const std::vector<Panel>& panels, const std::vector<double>& places,
                Figure& figure) {
  if (panels.empty() || panels.front().curves.empty()) return;
  const double last = places.back();
  const std::size_t rows = add_legend(panels.front(), figure);
  const std::size_t top = rows * kLegendRowPixels + 24;
  figure.height = std::max(figure.height, kAxisPixels + panels.size() * kLeastPanelPixels) + top;
  const auto share = [&](std::size_t pixels) {
    return exact_text(static_cast<double>(pixels) / static_cast<double>(figure.height));
  };
  for (const Panel& panel : panels) figure.script += bands_of(panel, last);
  figure.script += "set xrange [0:" + exact_text(last) + "]\nset multiplot layout " +
                   std::to_string(panels.size()) + ",1 margins 0.085,0.985," + share(kAxisPixels) +
                   "," + share(figure.height - top) + " spacing 0.05\n";
  for (std::size_t p = 0; p < panels.size(); ++p) {
    const bool lowest = p + 1 == panels.size();
    figure.script += lowest ? "set xlabel " + gnuplot_quoted(figure.chart.x_label) +
                                  " offset 0,0.4\nset format x '%h'\n"
                            : "unset xlabel\nset format x ''\n";
    if (p > 0) figure.script += "set key off\n";
    const ChartAxis axis = axis_of(panels[p]);
    const ThinnedSeries series = thinned(panels[p], places);
    figure.script += axis_script(panels[p].label, axis) + plot_of(panels[p], p == 0);
    figure.data.push_back(data_of(panels[p].name + ".csv", figure.chart.x_label, series));
    figure.chart.panels.push_back(chart_panel(panels[p], axis, series));
  }
  figure.script += "unset multiplot\n";
  figure.chart.x_to = last;
}

}  // namespace montecarta
