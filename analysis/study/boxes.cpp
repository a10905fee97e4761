// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/boxes.hpp"

#include "analysis/statistics/quantile.hpp"
#include "analysis/statistics/spread.hpp"
#include "engine/errors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace montecarta::analysis {
namespace {

constexpr double kHalfBox = 0.3, kHalfCap = 0.14;  // heights, of the distance between rows
constexpr double kMedianThickness = 3.0;           // [px]
constexpr double kLogarithmicSpan = 30.0;          // boxes that span more have a logarithmic axis

/// The quantiles with their names.
std::array<std::pair<const char*, double>, 5> named(const FiveNumbers& box) {
  return {{{"5 %", box.low},
           {"25 %", box.lower_quartile},
           {"median", box.median},
           {"75 %", box.upper_quartile},
           {"95 %", box.high}}};
}

/// A line that the pen draws in parts.
class BoxOutline {
 public:
  explicit BoxOutline(ChartMarks& marks) : marks_(&marks) {}
  void add(std::initializer_list<std::pair<double, double>> corners) {
    if (!marks_->x.empty()) put(kNaN, kNaN);
    for (const auto& [x, y] : corners) put(x, y);
  }

 private:
  void put(double x, double y) {
    marks_->x.push_back(x);
    marks_->y.push_back(y);
  }
  ChartMarks* marks_;
};

/// The unit of "position RMSE of a run [m]" as " [m]".
std::string unit_of(const std::string& label) {
  const std::size_t at = label.rfind(" [");
  return at == label.npos ? "" : label.substr(at);
}

void add_facts(const FiveNumbers& box, const std::string& x_label, ChartMarks& marks) {
  for (const auto& [name, value] : named(box)) {
    marks.facts.push_back({name + unit_of(x_label), std::vector<double>(marks.x.size(), value)});
  }
}

/// The marks of one box, in the row at y = `row`.
void add_box(const BoxRow& of, const FiveNumbers& box, double row, const std::string& x_label,
             std::vector<ChartMarks>& marks) {
  const double top = row - kHalfBox, bottom = row + kHalfBox;
  ChartMarks& outline = marks.emplace_back();
  outline.cell = of.name;
  outline.style = of.style;
  BoxOutline pen(outline);
  pen.add({{box.lower_quartile, top},
           {box.upper_quartile, top},
           {box.upper_quartile, bottom},
           {box.lower_quartile, bottom},
           {box.lower_quartile, top}});
  pen.add({{box.low, row}, {box.lower_quartile, row}});
  pen.add({{box.upper_quartile, row}, {box.high, row}});
  for (const double end : {box.low, box.high})
    pen.add({{end, row - kHalfCap}, {end, row + kHalfCap}});
  add_facts(box, x_label, outline);
  ChartMarks& median = marks.emplace_back();
  median.cell = of.name;
  median.style = of.style;
  median.thickness = kMedianThickness;
  BoxOutline(median).add({{box.median, top}, {box.median, bottom}});
  add_facts(box, x_label, median);
}

/// The range of the horizontal axis.
void set_range(double least, double greatest, Chart& chart) {
  constexpr double kRoomOfLinear = 1.05, kRoomOfLogarithmic = 1.3;
  chart.x_logarithmic = least > 0.0 && greatest > kLogarithmicSpan * least;
  chart.x_from = chart.x_logarithmic ? least / kRoomOfLogarithmic : std::min(0.0, least);
  chart.x_to = greatest * (chart.x_logarithmic ? kRoomOfLogarithmic : kRoomOfLinear);
  if (!(chart.x_to > chart.x_from)) chart.x_to = chart.x_from + 1.0;
}

}  // namespace

FiveNumbers five_numbers(std::vector<double> values) {
  expect(!values.empty(), "a box of no values");
  return {quantile_of(values, 0.05), quantile_of(values, 0.25), quantile_of(values, 0.5),
          quantile_of(values, 0.75), quantile_of(values, 0.95)};
}

void add_boxes(const std::vector<BoxRow>& rows, const std::string& x_label, Figure& figure) {
  ChartPanel panel;
  Frame numbers;
  double least = kNaN, greatest = kNaN;
  for (const BoxRow& row : rows) {
    std::vector<double> values = row.values;
    std::erase_if(values, [](double value) { return !std::isfinite(value); });
    if (values.empty()) continue;
    const auto n = static_cast<double>(values.size());
    const FiveNumbers box = five_numbers(std::move(values));
    add_box(row, box, static_cast<double>(panel.names.size()), x_label, panel.marks);
    panel.names.push_back(row.name);
    least = std::fmin(least, box.low);
    greatest = std::fmax(greatest, box.high);
    Frame::Row of_file = {{"cell", row.name}, {"runs", "1", n}};
    for (const auto& [name, value] : named(box)) of_file.emplace_back(name, "1", value);
    numbers.add(of_file);
  }
  if (panel.names.empty()) return;
  panel.axis = {false, static_cast<double>(panel.names.size()) - 0.5, -0.5};
  figure.chart.x_label = x_label;
  set_range(least, greatest, figure.chart);
  figure.chart.panels.push_back(std::move(panel));
  figure.data.push_back({figure.name + ".csv", std::move(numbers)});
}

}  // namespace montecarta::analysis
