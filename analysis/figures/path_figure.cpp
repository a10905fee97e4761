// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/figures/path_figure.hpp"

#include "analysis/data/run_reader.hpp"
#include "analysis/figures/path_bounds.hpp"
#include "analysis/figures/path_data.hpp"
#include "engine/numbers/real.hpp"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

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
      errors.push_back(length(row[3] - row[1], row[4] - row[2]));
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

constexpr std::size_t kMostPanels = 8, kMostRecordedPanels = 18;

DrawnPath drawn_path(const ResultFile& file, std::size_t cell_index, std::size_t run_index) {
  const StoredCell& cell = file.cells()[cell_index];
  const RunRows run = read_run(file, cell, run_index);
  DrawnPath drawn{
      cell.label, cell_index, path_data(file, cell, run), {}, map_data(file, cell, run_index)};
  // On a recorded drive they would be far smaller than a line is thick.
  if (file.has_truth()) drawn.poses = pose_ellipses(cell, run);
  return drawn;
}

std::vector<DrawnPath> drawn_cells(const ResultFile& file, std::size_t run_index) {
  const std::size_t most = file.has_truth() ? kMostPanels : kMostRecordedPanels;
  std::vector<DrawnPath> cells;
  for (std::size_t c = 0; c < file.cells().size() && cells.size() < most; ++c) {
    if (file.status(file.cells()[c])[run_index] != RunStatus::complete) continue;
    if (!file.cells()[c].has("pose_mean")) continue;
    cells.push_back(drawn_path(file, c, run_index));
  }
  return cells;
}

std::string sentence_of(const ResultFile& file, std::size_t run_index, std::size_t cells) {
  const std::string run = "Run " + std::to_string(file.runs()[run_index]);
  if (file.has_truth()) {
    return run +
           ": the true path in grey, the filter's in colour. Ellipses hold two standard deviations "
           "of the pose, at " +
           std::to_string(kPoseEllipses) +
           " moments, and of landmarks at the end: where the filter is consistent, the truth is "
           "seldom "
           "outside.";
  }
  return run +
         ", as it stands, not aligned: the filter's path in colour over the fixes of the reference "
         "as grey dots, with the landmarks of its map at the end. The panels reach no farther than "
         "a quarter beyond the fixes: a filter that lost the map may leave them." +
         (cells == kMostRecordedPanels
              ? " The first " + std::to_string(cells) + " cells that completed the run."
              : "");
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

Figure path_figure(const ResultFile& file, std::optional<std::uint64_t> run) {
  Figure figure{"paths", "Where did the filter think it was?", ""};
  const auto run_index = chosen_run(file, run);
  const auto cells = run_index ? drawn_cells(file, *run_index) : std::vector<DrawnPath>{};
  if (cells.empty()) return figure;
  figure.sentence = sentence_of(file, *run_index, cells.size());
  for (const DrawnPath& cell : cells) {
    figure.data.insert(figure.data.end(), {cell.path, cell.map});
    if (file.has_truth()) figure.data.push_back(cell.poses);
  }
  const FigureData landmarks = landmark_data(file, *run_index);
  const FigureData fixes = file.has_truth() ? FigureData{} : fix_data(file, *run_index);
  if (!file.has_truth()) figure.data.push_back(fixes);
  figure.data.push_back(landmarks);
  const Bounds bounds =
      file.has_truth() ? path_bounds(figure.data) : recorded_bounds(figure.data, fixes, landmarks);
  figure.chart = path_chart(cells, landmarks, fixes, bounds);
  return figure;
}

}  // namespace montecarta::analysis
