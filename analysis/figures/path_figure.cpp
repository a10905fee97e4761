// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/figures/path_figure.hpp"

#include "analysis/data/run_reader.hpp"
#include "analysis/figures/chosen_run.hpp"
#include "analysis/figures/gnuplot.hpp"
#include "analysis/figures/path_chart.hpp"
#include "analysis/figures/path_data.hpp"
#include "analysis/figures/path_layout.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace montecarta {
namespace {

constexpr std::size_t kMostPanels = 8, kMostRecordedPanels = 18;

/// Plots of one panel; an empty data file would be an error to gnuplot.
class PanelScript {
 public:
  explicit PanelScript(const std::string& title)
      : title_("set title " + gnuplot_quoted(title) + " noenhanced offset 0,-0.5\n") {}
  void add(const FigureData& data, const std::string& how) {
    if (data.rows.empty()) return;
    script_ += (script_.empty() ? "plot " : ", \\\n  ") + gnuplot_quoted("../data/" + data.name) +
               " " + how + " notitle";
  }
  std::string text() const { return title_ + script_ + "\n"; }

 private:
  std::string title_, script_;
};

constexpr const char* kTruth = "with lines linewidth 3 linecolor rgb '#aaaaaa'";
constexpr const char* kFix = "with points pointtype 7 pointsize 0.35 linecolor rgb '#aaaaaa'";
constexpr const char* kLandmark = "with points pointtype 1 pointsize 0.6 linecolor rgb 'black'";

std::string estimated_landmark(std::size_t style) {
  return "with points pointtype 6 pointsize 0.5 " + line_style(style);
}

/// What all panels show besides the estimate.
struct Surroundings {
  std::size_t run = 0;   ///< index in the file
  FigureData landmarks;  ///< true ones
  FigureData fixes;      ///< of a recorded drive
};

DrawnPath drawn_path(const ResultFile& file, std::size_t cell_index, std::size_t run_index) {
  const StoredCell& cell = file.cells()[cell_index];
  const RunRows run = read_run(file, cell, run_index);
  DrawnPath drawn{
      cell.label, cell_index, path_data(file, cell, run), {}, map_data(file, cell, run_index)};
  // On a recorded drive they would be far smaller than a line is thick.
  if (file.has_truth()) drawn.poses = pose_ellipses(cell, run);
  return drawn;
}

/// Truth below, estimate above.
std::string panel_of(const DrawnPath& cell, const Surroundings& around) {
  const std::string style = line_style(cell.style);
  const std::string ellipses = "using 1:2:3:4:5 with ellipses fillstyle empty border " + style;
  PanelScript panel(cell.label);
  panel.add(cell.path, std::string("using 2:3 ") + kTruth);
  panel.add(around.landmarks, std::string("using 1:2 ") + kLandmark);
  panel.add(cell.map, ellipses);
  panel.add(cell.path, "using 4:5 with lines " + style);
  panel.add(cell.poses, ellipses);
  return panel.text();
}

/// The same of a recorded drive, many times larger than any ellipse: fixes below, estimate above.
std::string recorded_panel_of(const DrawnPath& cell, const Surroundings& around) {
  PanelScript panel(cell.label);
  panel.add(around.fixes, std::string("using 2:3 ") + kFix);
  panel.add(cell.path, "using 2:3 with lines " + line_style(cell.style));
  panel.add(cell.map, "using 1:2 " + estimated_landmark(cell.style));
  panel.add(around.landmarks, std::string("using 1:2 ") + kLandmark);
  return panel.text();
}

/// Where points lie: (x, y) in columns `x` and `x` + 1 of data whose name begins with `name`.
void include(const std::vector<FigureData>& all, const std::string& name, std::size_t x,
             Bounds& bounds) {
  for (const FigureData& data : all) {
    if (!data.name.starts_with(name)) continue;
    for (const auto& row : data.rows) bounds.include(row[x], row[x + 1]);
  }
}

Bounds bounds_of(const std::vector<FigureData>& all) {
  Bounds bounds;
  include(all, "path_", 1, bounds);
  include(all, "path_", 3, bounds);
  include(all, "landmarks.csv", 0, bounds);
  return bounds.widened();
}

/// Without the few fixes that lie far from all others.
Bounds bounds_of_fixes(const FigureData& fixes) {
  constexpr double kWild = 0.01;
  Bounds bounds;
  std::vector<double> x, y;
  for (const auto& row : fixes.rows) {
    x.push_back(row[1]);
    y.push_back(row[2]);
  }
  if (x.empty()) return bounds;
  std::ranges::sort(x);
  std::ranges::sort(y);
  const auto cut = static_cast<std::size_t>(kWild * static_cast<double>(x.size()));
  bounds.include(x[cut], y[cut]);
  bounds.include(x[x.size() - 1 - cut], y[y.size() - 1 - cut]);
  return bounds;
}

/// A filter that is lost may be anywhere: paths and maps reach no farther than a quarter beyond the
/// fixes.
Bounds recorded_bounds(const std::vector<FigureData>& all, const Surroundings& around) {
  Bounds bounds = bounds_of_fixes(around.fixes);
  const Bounds limit = bounds.grown(0.25);
  const bool limited = !bounds.empty();
  for (const FigureData& data : all) {
    const std::size_t x = data.name.starts_with("path_") ? 1 : 0;
    if (x == 0 && !data.name.starts_with("map_")) continue;
    for (const auto& row : data.rows) {
      if (!limited || limit.contains(row[x], row[x + 1])) bounds.include(row[x], row[x + 1]);
    }
  }
  include({around.landmarks}, "landmarks.csv", 0, bounds);
  return bounds.widened();
}

std::vector<DrawnPath> drawn_cells(const ResultFile& file, std::size_t run_index) {
  const std::size_t most = file.has_truth() ? kMostPanels : kMostRecordedPanels;
  std::vector<DrawnPath> cells;
  for (std::size_t c = 0; c < file.cells().size() && cells.size() < most; ++c) {
    if (file.status(file.cells()[c])[run_index] != RunStatus::complete) continue;
    cells.push_back(drawn_path(file, c, run_index));
  }
  return cells;
}

void draw_paths(const ResultFile& file, const std::vector<DrawnPath>& cells,
                const Surroundings& around, Figure& figure) {
  figure.sentence = "Run " + std::to_string(file.runs()[around.run]) +
                    ": the true path in grey, the filter's in colour. Ellipses hold two standard "
                    "deviations of the pose, at " +
                    std::to_string(kPoseEllipses) +
                    " moments, and of landmarks at the end: where the filter is honest, the truth "
                    "is seldom outside.";
  std::vector<std::string> panels;
  for (const DrawnPath& cell : cells) panels.push_back(panel_of(cell, around));
  figure.data.push_back(around.landmarks);
  const Bounds bounds = bounds_of(figure.data);
  figure.chart = path_chart(cells, around.landmarks, {}, bounds);
  lay_out_maps(bounds, panels,
               {{kTruth, "true path"},
                {kLandmark, "landmark"},
                {"with lines " + line_style(0), "estimate"},
                {"with points pointtype 6 pointsize 1.2 " + line_style(0), "2 sigma"}},
               figure);
}

void draw_recorded_paths(const ResultFile& file, const std::vector<DrawnPath>& cells,
                         const Surroundings& around, Figure& figure) {
  figure.sentence =
      "Run " + std::to_string(file.runs()[around.run]) +
      ", as it stands, not aligned: the filter's path in colour over the fixes of "
      "the reference as grey dots, with the landmarks of its map at the end. The "
      "panels reach no farther than a quarter beyond the fixes: a filter that lost "
      "the map may leave them." +
      (cells.size() == kMostRecordedPanels
           ? " The first " + std::to_string(cells.size()) + " cells that completed the run."
           : "");
  std::vector<std::string> panels;
  for (const DrawnPath& cell : cells) panels.push_back(recorded_panel_of(cell, around));
  std::vector<LegendEntry> legend = {{"with lines " + line_style(0), "estimate"}};
  if (!around.fixes.rows.empty()) {
    legend.emplace_back("with points pointtype 7 pointsize 0.5 linecolor rgb '#aaaaaa'",
                        "fix of " + file.references().front().name);
  }
  legend.emplace_back("with points pointtype 6 pointsize 0.8 " + line_style(0),
                      "estimated landmark");
  if (!around.landmarks.rows.empty()) legend.emplace_back(kLandmark, "surveyed landmark");
  figure.data.insert(figure.data.end(), {around.fixes, around.landmarks});
  const Bounds bounds = recorded_bounds(figure.data, around);
  figure.chart = path_chart(cells, around.landmarks, around.fixes, bounds);
  lay_out_maps(bounds, panels, legend, figure);
}

}  // namespace

Figure path_figure(const ResultFile& file, std::optional<std::uint64_t> run) {
  Figure figure{"paths", "Where did the filter think it was?", "", 900, 0, "", {}};
  const auto run_index = chosen_run(file, run);
  const auto cells = run_index ? drawn_cells(file, *run_index) : std::vector<DrawnPath>{};
  if (cells.empty()) return figure;
  for (const DrawnPath& cell : cells) {
    figure.data.insert(figure.data.end(), {cell.path, cell.map});
    if (file.has_truth()) figure.data.push_back(cell.poses);
  }
  const Surroundings around{*run_index, landmark_data(file, *run_index), fix_data(file)};
  if (file.has_truth()) {
    draw_paths(file, cells, around, figure);
  } else {
    draw_recorded_paths(file, cells, around, figure);
  }
  return figure;
}

}  // namespace montecarta
