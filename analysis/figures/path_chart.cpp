// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/figures/path_chart.hpp"

#include <cmath>
#include <utility>

namespace montecarta::analysis {
namespace {

using Shape = ChartMarks::Shape;

std::vector<double> column(const FigureData& data, std::size_t which) {
  std::vector<double> values;
  for (const auto& row : data.rows) values.push_back(row[which]);
  return values;
}

/// Marks at columns `x` and `x` + 1.
ChartMarks marks_at(const FigureData& data, std::size_t x, const std::string& name, Shape shape,
                    std::size_t style) {
  ChartMarks marks;
  marks.name = name;
  marks.style = style;
  marks.shape = shape;
  marks.x = column(data, x);
  marks.y = column(data, x + 1);
  return marks;
}

ChartMarks ellipses_of(const FigureData& data, const std::string& name, std::size_t style) {
  ChartMarks marks = marks_at(data, 0, name, Shape::ellipses, style);
  marks.width = column(data, 2);
  marks.height = column(data, 3);
  marks.angle = column(data, 4);
  marks.facts = {{data.headings[2], marks.width}, {data.headings[3], marks.height}};
  return marks;
}

/// (time, true x, true y, x, y) or, where nobody knows the truth, (time, x, y).
void add_paths(const DrawnPath& cell, ChartPanel& panel) {
  const bool has_truth = cell.path.headings.size() == 5;
  const std::size_t x = has_truth ? 3 : 1;
  ChartMarks estimate = marks_at(cell.path, x, "estimate", Shape::line, cell.style);
  estimate.facts = {{"time [s]", column(cell.path, 0)}};
  if (has_truth) {
    ChartMarks truth = marks_at(cell.path, 1, "true path", Shape::line, kTruthStyle);
    truth.thickness = 3.0;
    truth.facts = estimate.facts;
    std::vector<double> errors;
    for (const auto& row : cell.path.rows) {
      errors.push_back(std::hypot(row[3] - row[1], row[4] - row[2]));
    }
    estimate.facts.push_back({"position error [m]", errors});
    panel.marks.push_back(std::move(truth));
  }
  panel.marks.push_back(std::move(estimate));
}

ChartPanel panel_of(const DrawnPath& cell, const FigureData& landmarks, const FigureData& fixes,
                    const Bounds& bounds) {
  ChartPanel panel{cell.label, {false, bounds.low, bounds.high}, {}, {}, {}, cell.label};
  if (!fixes.rows.empty()) {
    panel.marks.push_back(marks_at(fixes, 1, "fix", Shape::points, kTruthStyle));
    panel.marks.back().thickness = 3.0;
    panel.marks.back().facts = {{"time [s]", column(fixes, 0)}};
  }
  add_paths(cell, panel);
  if (!cell.map.rows.empty()) {
    panel.marks.push_back(ellipses_of(cell.map, "landmark of the map", cell.style));
  }
  if (!cell.poses.rows.empty()) {
    panel.marks.push_back(ellipses_of(cell.poses, "2 sigma of the pose", cell.style));
  }
  if (!landmarks.rows.empty()) {
    panel.marks.push_back(marks_at(landmarks, 0, "true landmark", Shape::crosses, kReferenceStyle));
  }
  for (ChartMarks& marks : panel.marks) {
    if (marks.style == cell.style) marks.cell = cell.label;
  }
  return panel;
}

}  // namespace

Chart path_chart(const std::vector<DrawnPath>& cells, const FigureData& landmarks,
                 const FigureData& fixes, const Bounds& bounds) {
  Chart chart{"x [m]", bounds.left, bounds.right, {}};
  chart.columns = 3;
  chart.least = 300;
  chart.aspect = (bounds.high - bounds.low) / (bounds.right - bounds.left);
  chart.is_map = true;
  for (const DrawnPath& cell : cells) {
    chart.panels.push_back(panel_of(cell, landmarks, fixes, bounds));
  }
  return chart;
}

}  // namespace montecarta::analysis
