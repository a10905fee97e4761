// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/figures/path_layout.hpp"

#include "analysis/figures/gnuplot.hpp"
#include "analysis/output/number_text.hpp"

#include <algorithm>

namespace montecarta {
namespace {

constexpr std::size_t kPathLegendPixels = 32;
constexpr std::size_t kRowGapPixels = 44;  // below a row: ticks and label of a short last row

/// Where panels lie across the figure, in shares of its width.
struct Columns {
  std::size_t count = 1;
  double left = 0.25, right = 0.75;  ///< one panel alone needs no more than half of the width
  double gap = 0.02;

  explicit Columns(std::size_t panels) : count(std::min<std::size_t>(panels, 3)) {
    if (count == 1) return;
    left = 0.085;
    right = 0.985;
  }
  double panel() const {
    const auto n = static_cast<double>(count);
    return (right - left - (n - 1.0) * gap) / n;
  }
};

/// A distance between ticks of 1, 2 or 5 times a power of ten that cuts `span` into 4 to 9 parts.
double tick_distance(double span) {
  const double power = std::pow(10.0, std::floor(std::log10(span / 4.0)));
  const double most = span / 4.0 / power;
  return power * (most >= 5.0 ? 5.0 : most >= 2.0 ? 2.0 : 1.0);
}

/// Ranges and ticks that all panels share: one scale in both directions.
std::string axes_of(const Bounds& bounds) {
  const double width = bounds.right - bounds.left, height = bounds.high - bounds.low;
  const std::string tick = exact_text(tick_distance(std::max(width, height)));
  const auto range = [](const char* name, double from, double to) {
    return std::string("set ") + name + " [" + exact_text(from) + ":" + exact_text(to) + "]\n";
  };
  return "set style ellipse units xx\nset size ratio -1\n" +
         range("xrange", bounds.left, bounds.right) + range("yrange", bounds.low, bounds.high) +
         "set xtics " + tick + "\nset ytics " + tick + "\n";
}

/// Where the panels lie; sets the figure's height.
std::string layout_of(std::size_t panels, const Bounds& bounds, Figure& figure) {
  const Columns columns(panels);
  const std::size_t rows = (panels + columns.count - 1) / columns.count;
  const double aspect = (bounds.high - bounds.low) / (bounds.right - bounds.left);
  const std::size_t title = 24, axis = 66;
  const auto panel =
      static_cast<std::size_t>(static_cast<double>(figure.width) * columns.panel() * aspect);
  figure.height = kPathLegendPixels + axis + rows * (panel + title) + (rows - 1) * kRowGapPixels;
  const auto share = [&](std::size_t pixels) {
    return readable(static_cast<double>(pixels) / static_cast<double>(figure.height), 5);
  };
  return axes_of(bounds) + "set multiplot layout " + std::to_string(rows) + "," +
         std::to_string(columns.count) + " margins " + readable(columns.left, 5) + "," +
         readable(columns.right, 5) + "," + share(axis) + "," +
         share(figure.height - kPathLegendPixels - title) + " spacing " + readable(columns.gap, 5) +
         "," + share(title + kRowGapPixels) + "\n";
}

/// A plot of nothing across the whole figure, for its legend: that of a panel is no wider than the
/// panel.
std::string legend_plot(const std::vector<LegendEntry>& legend, const Figure& figure) {
  const double bottom =
      1.0 - static_cast<double>(kPathLegendPixels) / static_cast<double>(figure.height);
  std::string script =
      "set size noratio\nset lmargin at screen 0\nset rmargin at screen 1\n"
      "set tmargin at screen 1\nset bmargin at screen " +
      readable(bottom, 5) +
      "\nunset title\nunset xlabel\nunset ylabel\nunset border\nunset tics\nunset grid\n"
      "set key inside center center horizontal Left reverse\nplot [0:1] [0:1] ";
  for (const auto& [how, words] : legend) {
    script += "keyentry " + how + " title " + gnuplot_quoted(words) + ", \\\n  ";
  }
  return script + "NaN notitle\n";
}

/// Only the outer panels number and name their axes: all have the same.
std::string labels_of(std::size_t panel, std::size_t panels) {
  const std::size_t columns = Columns(panels).count;
  const auto labels = [](bool outer, const std::string& axis, const std::string& offset) {
    return outer ? "set " + axis + "label '" + axis + " [m]' offset " + offset + "\nset format " +
                       axis + " '%h'\n"
                 : "unset " + axis + "label\nset format " + axis + " ''\n";
  };
  return labels(panel % columns == 0, "y", "1.5,0") +
         labels(panel + columns >= panels, "x", "0,0.4");
}

}  // namespace

void Bounds::include(double x, double y) {
  if (!std::isfinite(x) || !std::isfinite(y)) return;
  left = std::min(left, x);
  right = std::max(right, x);
  low = std::min(low, y);
  high = std::max(high, y);
}

Bounds Bounds::widened() const {
  const double width = right - left, height = high - low;
  const double room = 0.05 * std::max(width, height) + 1e-3;
  const double x = room + std::max(0.0, 0.25 * height - width) / 2.0;
  const double y = room + std::max(0.0, 0.25 * width - height) / 2.0;
  Bounds wide;
  wide.include(left - x, low - y);
  wide.include(right + x, high + y);
  return wide;
}

Bounds Bounds::grown(double share) const {
  const double room = share * std::max(right - left, high - low);
  Bounds wide;
  wide.include(left - room, low - room);
  wide.include(right + room, high + room);
  return wide;
}

void lay_out_maps(const Bounds& bounds, const std::vector<std::string>& panels,
                  const std::vector<LegendEntry>& legend, Figure& figure) {
  figure.script = layout_of(panels.size(), bounds, figure);
  for (std::size_t k = 0; k < panels.size(); ++k) {
    figure.script += labels_of(k, panels.size()) + panels[k];
  }
  figure.script += legend_plot(legend, figure) + "unset multiplot\n";
}

}  // namespace montecarta
