// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/render/figures/path_figure.hpp"

#include "analysis/run/run_reader.hpp"
#include "engine/errors.hpp"
#include "engine/numbers/real.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace montecarta::analysis {

Ellipse two_sigma_ellipse(double x, double y, double xx, double xy, double yy) {
  const double middle = 0.5 * (xx + yy);
  const double half_spread = length(0.5 * (xx - yy), xy);
  const double angle = 0.5 * std::atan2(2.0 * xy, xx - yy);
  const auto diameter = [](double variance) { return 4.0 * std::sqrt(variance); };
  return {x, y, diameter(middle + half_spread), diameter(middle - half_spread),
          angle * 180.0 / kPi};
}

StoredMap::StoredMap(const ResultFile& file, const StoredCell& cell, std::size_t run)
    : final_only_(!file.holds(cell, "map_seen", run)) {
  const std::string prefix = final_only_ ? "final_map_" : "map_";
  if (!file.holds(cell, prefix + "seen", run)) return;
  const Column* column = cell.find(prefix + "seen");
  seen_.resize(column->elements());
  mean_.resize(2 * seen_.size());
  covariance_.resize(4 * seen_.size());
  landmarks_ = column->shape.back();
  scans_ = landmarks_ == 0 ? 0 : seen_.size() / landmarks_;
  scans_ = std::min(scans_, drive_of_run(file, file.runs()[run]).scan_times.size());
  file.read(cell, prefix + "seen", run, std::span(seen_));
  file.read(cell, prefix + "mean", run, std::span(mean_));
  file.read(cell, prefix + "covariance", run, std::span(covariance_));
}

std::optional<Ellipse> StoredMap::at(std::size_t scan, std::size_t l) const {
  const std::size_t k = scan * landmarks_ + l;
  if (seen_[k] == 0.0) return std::nullopt;
  const double* P = covariance_.data() + 4 * k;
  return two_sigma_ellipse(mean_[2 * k], mean_[2 * k + 1], P[0], P[2], P[3]);
}

std::vector<Ellipse> StoredMap::at(std::size_t scan) const {
  std::vector<Ellipse> ellipses;
  for (std::size_t l = 0; l < landmarks_; ++l) {
    if (const auto ellipse = at(scan, l)) ellipses.push_back(*ellipse);
  }
  return ellipses;
}

namespace {

/// Extends `bounds` to the points (x, y) in columns `x` and `x` + 1, as far as they lie within the
/// limit.
void include(const Frame& points, std::size_t x, Bounds& bounds, const Bounds& limit = {}) {
  for (std::size_t k = 0; k < points.rows(); ++k) {
    const double at_x = points.columns[x].numbers[k], at_y = points.columns[x + 1].numbers[k];
    if (limit.empty() || limit.contains(at_x, at_y)) bounds.include(at_x, at_y);
  }
}

/// Bounds of the fixes without the few that lie far from all others.
Bounds bounds_of_fixes(const Frame& fixes) {
  constexpr double kWild = 0.01;
  Bounds bounds;
  if (fixes.rows() == 0) return bounds;
  std::vector<double> x = fixes.columns[1].numbers, y = fixes.columns[2].numbers;
  std::ranges::sort(x);
  std::ranges::sort(y);
  const auto cut = static_cast<std::size_t>(kWild * static_cast<double>(x.size()));
  bounds.include(x[cut], y[cut]);
  bounds.include(x[x.size() - 1 - cut], y[y.size() - 1 - cut]);
  return bounds;
}

}  // namespace

void Bounds::include(double x, double y) {
  constexpr double kBeyondAnyMap = 1e100;  // [m] farther points are ignored
  if (!(std::abs(x) < kBeyondAnyMap && std::abs(y) < kBeyondAnyMap)) return;
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

namespace {

/// Bounds of landmarks, and of paths with their truth.
Bounds path_bounds(const std::vector<DrawnPath>& cells, const FigureData& landmarks) {
  Bounds bounds;
  for (const DrawnPath& cell : cells) {
    include(cell.path.frame, 1, bounds);
    include(cell.path.frame, 3, bounds);
  }
  include(landmarks.frame, 0, bounds);
  return bounds.widened();
}

/// Bounds for a recorded drive. A lost filter may be anywhere, so paths and maps reach no farther
/// than a quarter beyond the fixes.
Bounds recorded_bounds(const std::vector<DrawnPath>& cells, const FigureData& fixes,
                       const FigureData& landmarks) {
  Bounds bounds = bounds_of_fixes(fixes.frame);
  const Bounds limit = bounds.grown(0.25);
  for (const DrawnPath& cell : cells) {
    include(cell.path.frame, 1, bounds, limit);
    include(cell.map.frame, 0, bounds, limit);
  }
  include(landmarks.frame, 0, bounds);
  return bounds.widened();
}

/// Returns {run} the number of cells in which the run is complete.
std::vector<std::size_t> completeness(const ResultFile& file) {
  std::vector<std::size_t> cells(file.runs().size());
  for (const StoredCell& cell : file.cells()) {
    const auto status = file.status(cell);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      cells[i] += status[i] == RunStatus::complete ? 1 : 0;
    }
  }
  return cells;
}

constexpr std::size_t kMostPoints = 500;
// More points for a recorded drive, which is kilometres long.
constexpr std::size_t kMostRecorded = 1500;
constexpr std::size_t kMostFixes = 600;
constexpr std::size_t kPoseEllipses = 16;  // number of ellipses along a path

const Frame kNoEllipses{
    {{"x", "m"}, {"y", "m"}, {"major diameter", "m"}, {"minor diameter", "m"}, {"angle", "deg"}}};
const Frame kNoFixes{{{"time", "s"}, {"x", "m"}, {"y", "m"}}};

void add(const Ellipse& e, Frame& frame) { frame.push({e.x, e.y, e.major, e.minor, e.angle}); }

}  // namespace

std::optional<std::size_t> chosen_run(const ResultFile& file, std::optional<std::uint64_t> run) {
  if (run) {
    const auto found = std::ranges::find(file.runs(), *run);
    if (found == file.runs().end()) {
      throw StudyError("{}: run {} (the file does not hold it): choose another with --run",
                       file.path(), *run);
    }
    return static_cast<std::size_t>(found - file.runs().begin());
  }
  const auto cells = completeness(file);
  const auto best = std::ranges::max_element(cells);
  if (best == cells.end() || *best == 0) return std::nullopt;
  return static_cast<std::size_t>(best - cells.begin());
}

FigureData fix_data(const ResultFile& file, std::size_t run_index) {
  const auto references = drive_of_run(file, file.runs()[run_index]).references;
  if (references.empty()) return {"fixes.csv", kNoFixes};
  const ReferencePath& path = references.front();
  FigureData data{"fixes_" + path.name + ".csv", kNoFixes};
  const std::size_t stride = 1 + path.time.size() / kMostFixes;
  for (std::size_t f = 0; f < path.time.size(); f += stride) {
    data.frame.push({path.time[f], path.position[f].x(), path.position[f].y()});
  }
  return data;
}

namespace {

/// Rows (time, true x, true y, x, y) at most some hundred scans of a run; (time, x, y) without a
/// known truth.
FigureData path_data(const ResultFile& file, const StoredCell& cell, const RunRows& run) {
  FigureData data{"path_" + cell.label + ".csv", {{{"time", "s"}, {"x", "m"}, {"y", "m"}}}};
  const bool has_truth = !run.truth.empty();
  auto& columns = data.frame.columns;
  if (has_truth) columns.insert(columns.begin() + 1, {{"true x", "m"}, {"true y", "m"}});
  const auto times = drive_of_run(file, run.run).scan_times;
  const auto& mean = estimate_of(run).mean;
  const std::size_t stride = 1 + times.size() / (has_truth ? kMostPoints : kMostRecorded);
  for (std::size_t s = 0; s < times.size(); s += stride) {
    const double x = mean[3 * s], y = mean[3 * s + 1];
    if (has_truth) {
      data.frame.push({times[s], run.truth[3 * s], run.truth[3 * s + 1], x, y});
    } else {
      data.frame.push({times[s], x, y});
    }
  }
  return data;
}

/// Two-sigma ellipses of the pose at kPoseEllipses moments; no rows without covariance.
FigureData pose_ellipses(const StoredCell& cell, const RunRows& run) {
  FigureData data{"pose_ellipses_" + cell.label + ".csv", kNoEllipses};
  const MomentRows& moments = estimate_of(run);
  const std::size_t scans = moments.covariance.size() / 9;
  const std::size_t ellipses = std::min(kPoseEllipses, scans);
  for (std::size_t k = 1; k <= ellipses; ++k) {
    const std::size_t s = k * scans / ellipses - 1;
    const double* P = moments.covariance.data() + 9 * s;
    add(two_sigma_ellipse(moments.mean[3 * s], moments.mean[3 * s + 1], P[0], P[3], P[4]),
        data.frame);
  }
  return data;
}

/// Two-sigma ellipses of the landmarks in the map at the last scan. No rows if neither the map nor
/// the final map is stored for every run; a map stored for one run is in its replay.
FigureData map_data(const ResultFile& file, const StoredCell& cell, std::size_t run_index) {
  FigureData data{"map_" + cell.label + ".csv", kNoEllipses};
  if (!cell.has("map_seen") && !cell.has("final_map_seen")) return data;
  const StoredMap map(file, cell, run_index);
  if (map.scans() == 0) return data;
  for (const Ellipse& ellipse : map.at(map.scans() - 1)) add(ellipse, data.frame);
  return data;
}

/// True positions of the landmarks in a run.
FigureData landmark_data(const ResultFile& file, std::size_t run_index) {
  FigureData data{"landmarks.csv", {{{"x", "m"}, {"y", "m"}}}};
  for (const auto& at : file.landmarks_of(run_index)) data.frame.push({at.x(), at.y()});
  return data;
}

using Shape = ChartMarks::Shape;

const std::vector<double>& column(const FigureData& data, std::size_t which) {
  return data.frame.columns[which].numbers;
}

/// Marks at the points in columns `x` and `x` + 1.
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
  marks.facts = {{"major diameter [m]", marks.width}, {"minor diameter [m]", marks.height}};
  return marks;
}

/// Adds paths from rows (time, true x, true y, x, y), or (time, x, y) without a known truth.
void add_paths(const DrawnPath& cell, ChartPanel& panel) {
  const bool has_truth = cell.path.frame.columns.size() == 5;
  const std::size_t x = has_truth ? 3 : 1;
  ChartMarks estimate = marks_at(cell.path, x, "estimate", Shape::line, cell.style);
  estimate.facts = {{"time [s]", column(cell.path, 0)}};
  if (has_truth) {
    ChartMarks truth = marks_at(cell.path, 1, "true path", Shape::line, kTruthStyle);
    truth.thickness = 3.0;
    truth.facts = estimate.facts;
    std::vector<double> errors;
    for (std::size_t k = 0; k < truth.x.size(); ++k) {
      errors.push_back(length(estimate.x[k] - truth.x[k], estimate.y[k] - truth.y[k]));
    }
    estimate.facts.push_back({"position error [m]", errors});
    panel.marks.push_back(std::move(truth));
  }
  panel.marks.push_back(std::move(estimate));
}

ChartPanel panel_of(const DrawnPath& cell, const FigureData& landmarks, const FigureData& fixes,
                    const Bounds& bounds) {
  ChartPanel panel{cell.label, {false, bounds.low, bounds.high}, {}, {}, {}, cell.label};
  if (fixes.frame.rows() > 0) {
    panel.marks.push_back(marks_at(fixes, 1, "fix", Shape::points, kTruthStyle));
    panel.marks.back().thickness = 3.0;
    panel.marks.back().facts = {{"time [s]", column(fixes, 0)}};
  }
  add_paths(cell, panel);
  if (cell.map.frame.rows() > 0) {
    panel.marks.push_back(ellipses_of(cell.map, "landmark of the map", cell.style));
  }
  if (cell.poses.frame.rows() > 0) {
    panel.marks.push_back(ellipses_of(cell.poses, "2 sigma of the pose", cell.style));
  }
  if (landmarks.frame.rows() > 0) {
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
  // On a recorded drive the ellipses would be far smaller than a line is thick.
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
  const std::string run = std::to_string(file.runs()[run_index]);
  if (file.has_truth()) {
    return prose("paths", "simulated", {{"run", run}, {"moments", std::to_string(kPoseEllipses)}});
  }
  std::string sentence = prose("paths", "recorded", {{"run", run}});
  if (cells != kMostRecordedPanels) return sentence;
  return sentence + " " + prose("paths", "first cells", {{"cells", std::to_string(cells)}});
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
  const auto run_index = chosen_run(file, run);
  const auto cells = run_index ? drawn_cells(file, *run_index) : std::vector<DrawnPath>{};
  if (cells.empty()) return {};
  Figure figure = figure_of("paths");
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
      file.has_truth() ? path_bounds(cells, landmarks) : recorded_bounds(cells, fixes, landmarks);
  figure.chart = path_chart(cells, landmarks, fixes, bounds);
  return figure;
}

}  // namespace montecarta::analysis
