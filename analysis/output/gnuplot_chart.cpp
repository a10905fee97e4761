// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/gnuplot.hpp"
#include "analysis/output/number_text.hpp"
#include "analysis/output/print_layout.hpp"
#include "engine/errors.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace montecarta::analysis {
namespace {

using Shape = ChartMarks::Shape;
/// Behind the legend, for which all of it is off.
constexpr const char* kPanelStyle = R"(set key off
set border 3 linewidth 0.8 linecolor rgb 'black'
set tics nomirror out scale 0.6
set grid linecolor rgb '#bbbbbb' linewidth 0.4 dashtype (2,4)
)";

/// On any axis: gnuplot knows no infinity.
double on_axis(double value) {
  constexpr double kLargest = 1e300;
  return std::isnan(value) ? 0.0 : std::clamp(value, -kLargest, kLargest);
}

std::string command_number(double value) { return exact_text(on_axis(value)); }

std::string range(const char* axis, double from, double to) {
  return std::string("set ") + axis + "range [" + command_number(from) + ":" + command_number(to) +
         "]\n";
}

/// Ticks with these names at 0, 1, 2, ...; gnuplot's own where there are none.
std::string ticks(const char* axis, const std::vector<std::string>& names) {
  std::string script = std::string("set ") + axis + "tics nomirror";
  if (names.empty()) return script + " autofreq\n";
  for (std::size_t i = 0; i < names.size(); ++i) {
    script += (i == 0 ? " (" : ", ") + gnuplot_quoted(names[i]) + " " + std::to_string(i);
  }
  return script + ")\n";
}

std::string ticks_at(const std::vector<double>& places) {
  std::string at;
  for (const double place : places) at += (at.empty() ? "" : ",") + command_number(place);
  return "set xtics nomirror (" + at + ")\n";
}

/// Of a logarithmic axis: 1, 2 and 5 of each decade, 1 alone of many.
std::string logarithmic_ticks(double from, double to) {
  expect(from > 0.0 && to < 1e200, "a logarithmic axis has positive ends");
  const bool is_long = to > 2000.0 * from;
  std::string at;
  for (double decade = std::pow(10.0, std::floor(std::log10(from))); decade <= to; decade *= 10.0) {
    for (const double step : {1.0, 2.0, 5.0}) {
      if (is_long && step > 1.0) continue;
      at += (at.empty() ? "" : ",") + readable(step * decade, 1);
    }
  }
  return "set xtics nomirror (" + at + ")\n";
}

/// One label for all columns stands below the drawing (common_label()).
std::string horizontal_axis(const Chart& chart, const ChartPanel& panel, const PanelBox& box) {
  const std::string label = box.is_alone_in_row
                                ? "set xlabel " + gnuplot_quoted(chart.x_label) + " offset 0,0.4\n"
                                : "unset xlabel\n";
  return std::string(chart.x_logarithmic ? "set" : "unset") + " logscale x\n" +
         (!chart.x_ticks.empty() ? ticks_at(chart.x_ticks)
          : chart.x_logarithmic  ? logarithmic_ticks(box.x_from, box.x_to)
                                 : ticks("x", panel.x_names)) +
         range("x", box.x_from, box.x_to) +
         (box.is_lowest ? "set format x '%h'\n" + label : "set format x ''\nunset xlabel\n");
}

std::string common_label(const Chart& chart, const PrintLayout& layout) {
  if (layout.boxes.front().is_alone_in_row) return "";
  return "set label " + gnuplot_quoted(chart.x_label) + " at screen 0.5, screen " +
         readable(10.0 / layout.height, 4) + " center\n";
}

/// As far as curves and bands reach, where the axis does not say.
double upper_end(const ChartPanel& panel) {
  if (!std::isnan(panel.axis.high)) return panel.axis.high;
  double greatest = panel.axis.low;
  const auto include = [&](double value) {
    if (std::isfinite(value)) greatest = std::max(greatest, value);
  };
  for (const ChartPanel::Curve& curve : panel.curves) {
    std::ranges::for_each(curve.values, include);
    std::ranges::for_each(curve.greatest, include);
  }
  for (const Band& band : panel.bands) include(band.upper);
  return greatest > panel.axis.low ? 1.05 * greatest : panel.axis.low + 1.0;
}

/// A distance of 1, 2 or 5 times a power of ten that leaves room for the numbers.
std::string linear_ticks(double from, double to, double pixels) {
  const double least = (on_axis(to) - on_axis(from)) * 26.0 / pixels;
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  const double steps = least / power;
  const double step = power * (steps <= 1.0 ? 1.0 : steps <= 2.0 ? 2.0 : steps <= 5.0 ? 5.0 : 10.0);
  return "set ytics nomirror " + command_number(step) + "\n";
}

std::string vertical_axis(const ChartPanel& panel, const PanelBox& box) {
  const ChartAxis& axis = panel.axis;
  const bool is_plain = !axis.logarithmic || (axis.low >= 0.01 && axis.high <= 1e4);
  const bool is_free = axis.logarithmic || !panel.y_names.empty();
  const double to = upper_end(panel);
  const std::string label = gnuplot_quoted(panel.label) + " noenhanced";
  return std::string(axis.logarithmic ? "set" : "unset") + " logscale y\n" +
         (is_free ? ticks("y", panel.y_names) : linear_ticks(axis.low, to, box.bottom - box.top)) +
         "set format y '" + (is_plain ? "%h" : "10^{%T}") + "'\n" + range("y", axis.low, to) +
         "unset label\n" +
         (box.has_heading
              ? "unset ylabel\nset label " + label + " at graph 0,1 left offset -3,0.8\n"
              : "set ylabel " + label + " offset 0.8,0\n");
}

std::string place(const PanelBox& box, double width, double height) {
  const auto margin = [](const char* side, double share) {
    return std::string("set ") + side + "margin at screen " + readable(share, 6) + "\n";
  };
  return margin("l", box.left / width) + margin("r", box.right / width) +
         margin("t", 1.0 - box.top / height) + margin("b", 1.0 - box.bottom / height);
}

/// Words within boxes; of points beside them, on the side where there is room, above and below by
/// turns from the lowest point up so that neighbours keep apart.
std::string texts(const Chart& chart, const ChartPanel& panel) {
  struct Text {
    double x, y;
    std::string words;
    bool is_within;
  };
  std::vector<Text> all;
  for (const ChartMarks& marks : panel.marks) {
    for (std::size_t i = 0; i < marks.text.size(); ++i) {
      if (!std::isfinite(marks.x[i]) || !std::isfinite(marks.y[i])) continue;
      all.push_back({marks.x[i], marks.y[i], marks.text[i], marks.shape == Shape::boxes});
    }
  }
  std::ranges::stable_sort(all, {}, &Text::y);
  const double middle = chart.x_logarithmic ? std::sqrt(chart.x_from * chart.x_to)
                                            : 0.5 * (chart.x_from + chart.x_to);
  std::string script;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto& [x, y, words, is_within] = all[i];
    const bool left = x > middle;
    script += "set label " + gnuplot_quoted(words) + " at " + command_number(x) + "," +
              command_number(y) + " noenhanced front " +
              (is_within ? "center textcolor rgb '#111111'\n"
                         : std::string(left ? "right offset -0.8," : "left offset 0.8,") +
                               (i % 2 == 0 ? "-0.5\n" : "0.5\n"));
  }
  return script;
}

struct LegendEntry {
  std::string how, words;
};

/// Bands, then cells that no heading names or, on maps, what is drawn.
std::vector<LegendEntry> legend_of(const Chart& chart) {
  std::vector<LegendEntry> entries;
  const auto add = [&](const std::string& how, const std::string& words) {
    if (words.empty() || std::ranges::find(entries, words, &LegendEntry::words) != entries.end())
      return;
    entries.push_back({how, words});
  };
  for (const Band& band : chart.panels.front().bands) add(band_style(), band.legend);
  for (const ChartPanel& panel : chart.panels) {
    for (const auto& curve : panel.curves) add(curve_style(curve.style), curve.legend);
    for (const ChartMarks& marks : panel.marks) {
      if (!marks.text.empty()) continue;
      const bool is_named = panel.cell == marks.cell;
      if (chart.is_map || !is_named) add(mark_style(marks), chart.is_map ? marks.name : marks.cell);
    }
  }
  return entries;
}

std::size_t legend_columns(const std::vector<LegendEntry>& entries, std::size_t width) {
  std::size_t longest = 8;
  for (const LegendEntry& entry : entries) longest = std::max(longest, entry.words.size());
  return std::clamp<std::size_t>((width - 90) / (8 * longest + 68), 1, entries.size());
}

/// A plot of nothing across the whole drawing: the legend of a panel is no wider than the panel.
std::string legend_plot(const std::vector<LegendEntry>& entries, std::size_t columns,
                        const PanelBox& box, double width, double height) {
  std::string script = "unset border\nunset tics\nunset grid\n" + place(box, width, height) +
                       "set key inside left top horizontal Left reverse maxcols " +
                       std::to_string(columns) + "\nplot [0:1] [0:1] ";
  for (const auto& [how, words] : entries) {
    script += "keyentry with " + how + " title " + gnuplot_quoted(words) + ", \\\n  ";
  }
  return script + "NaN notitle\n";
}

}  // namespace

GnuplotChart gnuplot_chart(const Chart& chart, std::size_t width) {
  constexpr std::size_t kLegendRow = 20;  // [px]
  const std::vector<LegendEntry> legend = legend_of(chart);
  const std::size_t columns = legend.empty() ? 1 : legend_columns(legend, width);
  const std::size_t legend_height =
      (legend.size() + columns - 1) / columns * kLegendRow + (legend.empty() ? 0 : 8);
  const auto w = static_cast<double>(width);
  const PrintLayout layout = print_layout(chart, w, static_cast<double>(legend_height));
  GnuplotChart drawn{"", "set style ellipse units xx\nset multiplot\n",
                     static_cast<std::size_t>(layout.height)};
  if (!legend.empty()) {
    const PanelBox top{40.0, w - 10.0, 4.0, static_cast<double>(legend_height)};
    drawn.commands += legend_plot(legend, columns, top, w, layout.height);
  }
  drawn.commands += kPanelStyle;
  for (std::size_t k = 0; k < layout.boxes.size(); ++k) {
    const ChartPanel& panel = chart.panels[k / layout.views];
    const PanelPlots plots = panel_plots(chart, k / layout.views);
    if (k % layout.views == 0) drawn.numbers += plots.numbers;
    drawn.commands += place(layout.boxes[k], w, layout.height) +
                      horizontal_axis(chart, panel, layout.boxes[k]) +
                      vertical_axis(panel, layout.boxes[k]) + texts(chart, panel) +
                      (k == 0 ? common_label(chart, layout) : "") + "plot " + plots.commands + "\n";
  }
  drawn.commands += "unset multiplot\n";
  return drawn;
}

}  // namespace montecarta::analysis
