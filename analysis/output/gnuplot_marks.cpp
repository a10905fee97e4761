// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/gnuplot.hpp"
#include "analysis/output/number_text.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace montecarta::analysis {
namespace {

using Shape = ChartMarks::Shape;
using Columns = std::vector<const std::vector<double>*>;

constexpr double kBeyondAnyAxis = 1e100;  // gnuplot knows no infinity

/// A data block; a row whose first number is NaN interrupts a line.
std::string block(const std::string& name, const Columns& columns) {
  std::string text = name + " << EOD\n";
  for (std::size_t c = 0; c < columns.size(); ++c) text += c == 0 ? "x" : ",y";
  text += "\n";
  for (std::size_t r = 0; r < columns.front()->size(); ++r) {
    const bool is_gap = std::isnan((*columns.front())[r]);
    for (std::size_t c = 0; c < columns.size() && !is_gap; ++c) {
      text += (c == 0 ? "" : ",") +
              exact_text(std::clamp((*columns[c])[r], -kBeyondAnyAxis, kBeyondAnyAxis));
    }
    text += "\n";
  }
  return text + "EOD\n";
}

std::string colour_of(std::size_t style) { return " linecolor rgb '" + line_colour(style) + "'"; }

std::string line_style(std::size_t style) {
  return "linewidth 1.4" + colour_of(style) + " dashtype " +
         (style == kReferenceStyle ? "(6,4)" : std::to_string(line_dashes(style)));
}

/// Adds plots one above the other, each with a data block of its own.
class PanelWriter {
 public:
  PanelWriter(const Chart& chart, std::size_t panel)
      : chart_(chart), panel_(chart.panels[panel]), prefix_("$p" + std::to_string(panel) + "_") {}

  void add(const Band& band) {
    const std::vector<double> x = {chart_.x_from, chart_.x_to}, lower = {band.lower, band.lower},
                              upper = {band.upper, band.upper};
    plot({&x, &lower, &upper}, "1:2:3", band_style());
  }

  void add_curve(std::size_t i) {
    const ChartPanel::Curve& curve = panel_.curves[i];
    if (curve.least.empty()) {
      plot({&panel_.x, &curve.values}, "1:2", curve_style(curve.style));
      return;
    }
    // Bars of neighbouring curves must not cover each other.
    const auto bars = std::ranges::count_if(
        panel_.curves, [](const ChartPanel::Curve& one) { return !one.least.empty(); });
    const double place = static_cast<double>(i) - 0.5 * static_cast<double>(bars - 1);
    std::vector<double> x = panel_.x;
    for (double& at : x) at *= 1.0 + 0.03 * place;
    plot({&x, &curve.values}, "1:2", curve_style(curve.style));
    plot({&x, &curve.values, &curve.least, &curve.greatest}, "1:2:3:4",
         "yerrorbars pointtype 7 pointsize 0.5 " + line_style(curve.style));
  }

  void add(const ChartMarks& marks) {
    if (marks.x.empty()) return;  // an empty data block is an error to gnuplot
    if (marks.shape == Shape::ellipses) return add_ellipses(marks);
    if (marks.shape == Shape::boxes) return add_boxes(marks);
    plot({&marks.x, &marks.y}, "1:2", mark_style(marks));
  }

  PanelPlots result() const { return {numbers_, commands_.empty() ? "NaN notitle" : commands_}; }

 private:
  void plot(const Columns& columns, const std::string& which, const std::string& how) {
    const std::string name = prefix_ + std::to_string(count_++);
    numbers_ += block(name, columns);
    commands_ += (commands_.empty() ? "" : ", \\\n  ") + name + " using " + which + " with " + how +
                 " notitle";
  }

  /// None so small that it cannot be seen.
  void add_ellipses(const ChartMarks& marks) {
    const double least = 0.012 * (chart_.x_to - chart_.x_from);
    std::vector<double> width = marks.width, height = marks.height;
    for (double& one : width) one = one < least ? least : one;
    for (double& one : height) one = one < least ? least : one;
    plot({&marks.x, &marks.y, &width, &height, &marks.angle}, "1:2:3:4:5",
         "ellipses fillstyle empty border " + line_style(marks.style));
  }

  void add_boxes(const ChartMarks& marks) {
    const std::string corners = "1:2:($1-$3/2):($1+$3/2):($2-$4/2):($2+$4/2)";
    if (marks.fill.empty()) {
      plot({&marks.x, &marks.y, &marks.width, &marks.height}, corners,
           "boxxyerror " + line_style(marks.style) + " fillstyle transparent solid 0.35 border");
      return;
    }
    std::vector<double> colours;
    for (const std::string& fill : marks.fill) {
      colours.push_back(static_cast<double>(std::stoul(fill.substr(1), nullptr, 16)));
    }
    plot({&marks.x, &marks.y, &marks.width, &marks.height, &colours}, corners + ":5",
         "boxxyerror linecolor rgb variable fillstyle solid 1 noborder");
  }

  const Chart& chart_;
  const ChartPanel& panel_;
  std::string prefix_, numbers_, commands_;
  std::size_t count_ = 0;
};

}  // namespace

std::string band_style() {
  return "filledcurves fillcolor rgb '#707070' fillstyle transparent solid 0.45 border linecolor "
         "rgb '#666666' linewidth 0.6";
}

std::string curve_style(std::size_t style) { return "lines " + line_style(style); }

std::string mark_style(const ChartMarks& marks) {
  const auto points = [&](const char* type, double size) {
    return std::string("points pointtype ") + type + " pointsize " + exact_text(size) +
           colour_of(marks.style);
  };
  switch (marks.shape) {
    case Shape::line:
      if (marks.style == kReferenceStyle) return curve_style(marks.style);
      return "lines linewidth " + exact_text(marks.thickness > 0.0 ? marks.thickness : 1.4) +
             colour_of(marks.style);
    case Shape::points:
      return points("7", marks.thickness > 0.0 ? 0.1 * marks.thickness : 0.5);
    case Shape::crosses:
      return points("1", 0.6);
    case Shape::ellipses:
      return points("6", 1.2);
    case Shape::boxes:
      return points("5", 1.2);
  }
  return "";
}

PanelPlots panel_plots(const Chart& chart, std::size_t panel) {
  PanelWriter writer(chart, panel);
  const ChartPanel& drawn = chart.panels[panel];
  for (const Band& band : drawn.bands) writer.add(band);
  for (std::size_t i = 0; i < drawn.curves.size(); ++i) writer.add_curve(i);
  for (const ChartMarks& marks : drawn.marks) writer.add(marks);
  return writer.result();
}

}  // namespace montecarta::analysis
