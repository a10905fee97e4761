// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/figures/panel.hpp"

#include "analysis/figures/gnuplot.hpp"
#include "analysis/tables/number_text.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace montecarta {
namespace {

constexpr std::size_t kBuckets = 300;
constexpr double kLogarithmicFrom = 30.0;

struct Range {
  double least = std::numeric_limits<double>::infinity();
  double greatest = 0.0;
};

/// Of all positive values of a panel, bands included.
Range range_of(const Panel& panel) {
  Range range;
  const auto include = [&](double value) {
    if (!std::isfinite(value) || value <= 0.0) return;
    range.least = std::min(range.least, value);
    range.greatest = std::max(range.greatest, value);
  };
  for (const Curve& curve : panel.curves) std::ranges::for_each(curve.values, include);
  for (const Band& band : panel.bands) {
    include(band.lower);
    include(band.upper);
  }
  return range;
}

std::string axes_of(const Panel& panel) {
  const Range range = range_of(panel);
  std::string script = "set ylabel " + gnuplot_quoted(panel.label) + " noenhanced\n";
  if (panel.may_be_logarithmic && range.greatest > kLogarithmicFrom * range.least) {
    // Whole decades, so that the band and the ticks are where one looks for them.
    return script + "set logscale y\nset format y '%h'\nset yrange [" +
           exact_text(std::pow(10.0, std::floor(std::log10(range.least)))) + ":" +
           exact_text(std::pow(10.0, std::ceil(std::log10(range.greatest)))) + "]\n";
  }
  script += "unset logscale y\nset format y '%h'\n";
  return script + (panel.from_zero ? "set yrange [0:*]\n" : "set yrange [*:*]\n");
}

ThinnedSeries thinned(const Panel& panel, const std::vector<double>& times) {
  std::vector<NamedSeries> series;
  for (const Curve& curve : panel.curves) series.push_back({curve.legend, "1", curve.values});
  return thin(times, series, kBuckets);
}

std::string plot_of(const Panel& panel, double last_time, bool legend) {
  const auto title = [&](const std::string& text) {
    return text.empty() || !legend ? std::string(" notitle") : " title " + gnuplot_quoted(text);
  };
  std::string script = "plot ";
  for (const Band& band : panel.bands) {
    script += "[0:" + exact_text(last_time) + "] '+' using 1:(" + exact_text(band.lower) + "):(" +
              exact_text(band.upper) + ") with filledcurves linecolor rgb '#777777'" +
              title(band.legend) + ", \\\n  ";
  }
  for (std::size_t i = 0; i < panel.curves.size(); ++i) {
    script += (i == 0 ? "'../data/" + panel.name + ".csv'" : "''") +
              " using 1:" + std::to_string(i + 2) + " with lines " +
              line_style(panel.curves[i].style) + title(panel.curves[i].legend) +
              (i + 1 < panel.curves.size() ? ", \\\n  " : "\n");
  }
  return script;
}

}  // namespace

void add_panels(const std::vector<Panel>& panels, const std::vector<double>& times,
                Figure& figure) {
  const double last = times.back();
  const bool several = panels.size() > 1;
  figure.script += "set xrange [0:" + exact_text(last) + "]\nset lmargin 9\n";
  if (several) {
    figure.script += "set multiplot layout " + std::to_string(panels.size()) + ",1\n";
  }
  for (std::size_t p = 0; p < panels.size(); ++p) {
    const bool lowest = p + 1 == panels.size();
    figure.script += lowest ? "set xlabel 'time [s]'\n" : "unset xlabel\n";
    if (p > 0) figure.script += "set key off\n";
    figure.script += axes_of(panels[p]) + plot_of(panels[p], last, p == 0);
    figure.data.push_back(data_over_time(panels[p].name + ".csv", thinned(panels[p], times)));
  }
  if (several) figure.script += "unset multiplot\n";
}

}  // namespace montecarta
