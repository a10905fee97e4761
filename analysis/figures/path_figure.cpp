// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/figures/path_figure.hpp"

#include "analysis/figures/ellipse.hpp"
#include "analysis/figures/gnuplot.hpp"
#include "analysis/metrics/run_rows.hpp"
#include "analysis/run_reader.hpp"
#include "analysis/tables/number_text.hpp"
#include "engine/errors.hpp"

#include <algorithm>

namespace montecarta {
namespace {

constexpr std::size_t kMostPanels = 8;
constexpr std::size_t kMostPoints = 500;
constexpr std::size_t kPoseEllipses = 16;

using Rows = std::vector<std::vector<std::string>>;

std::vector<std::string> texts(const std::vector<double>& numbers) {
  std::vector<std::string> row;
  for (const double number : numbers) row.push_back(exact_text(number));
  return row;
}

const std::vector<std::string> kEllipseHeadings = {"x [m]", "y [m]", "major diameter [m]",
                                                   "minor diameter [m]", "angle [deg]"};

std::vector<std::string> ellipse_row(const Ellipse& e) {
  return texts({e.x, e.y, e.major, e.minor, e.angle});
}

/// In how many cells each run is complete.
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

/// Index in the file of the run to draw.
std::optional<std::size_t> choose_run(const ResultFile& file, std::optional<std::uint64_t> run) {
  if (run) {
    const auto found = std::ranges::find(file.runs(), *run);
    if (found == file.runs().end()) {
      throw StudyError(file.path().string() + ": run " + std::to_string(*run) +
                       " (the file does not hold it): choose another with --run");
    }
    return static_cast<std::size_t>(found - file.runs().begin());
  }
  const auto cells = completeness(file);
  const auto best = std::ranges::max_element(cells);
  if (best == cells.end() || *best == 0) return std::nullopt;
  return static_cast<std::size_t>(best - cells.begin());
}

FigureData path_data(const ResultFile& file, const StoredCell& cell, const RunRows& run) {
  FigureData data{"path_" + cell.label + ".csv",
                  {"time [s]", "true x [m]", "true y [m]", "x [m]", "y [m]"},
                  {}};
  const auto& times = file.scan_times();
  const auto& mean = run.mixture.mean.empty() ? run.spread.mean : run.mixture.mean;
  const std::size_t stride = 1 + times.size() / kMostPoints;
  for (std::size_t s = 0; s < times.size(); s += stride) {
    data.rows.push_back(
        texts({times[s], run.truth[3 * s], run.truth[3 * s + 1], mean[3 * s], mean[3 * s + 1]}));
  }
  return data;
}

FigureData pose_ellipses(const StoredCell& cell, const RunRows& run) {
  FigureData data{"pose_ellipses_" + cell.label + ".csv", kEllipseHeadings, {}};
  const MomentRows& moments = run.mixture.mean.empty() ? run.spread : run.mixture;
  const std::size_t scans = moments.covariance.size() / 9;
  for (std::size_t k = 1; k <= kPoseEllipses && scans > 0; ++k) {
    const std::size_t s = k * scans / kPoseEllipses - 1;
    const double* P = moments.covariance.data() + 9 * s;
    data.rows.push_back(ellipse_row(
        two_sigma_ellipse(moments.mean[3 * s], moments.mean[3 * s + 1], P[0], P[3], P[4])));
  }
  return data;
}

/// Landmarks that the filter has at the last scan.
FigureData map_data(const ResultFile& file, const StoredCell& cell, std::size_t run_index) {
  FigureData data{"map_" + cell.label + ".csv", kEllipseHeadings, {}};
  const auto column = std::ranges::find(cell.columns, std::string("map_seen"), &Column::name);
  if (column == cell.columns.end()) return data;
  const std::size_t all = column->elements(), landmarks = column->shape.back();
  std::vector<double> mean(2 * all), covariance(4 * all), seen(all);
  file.read(cell, "map_mean", run_index, std::span(mean));
  file.read(cell, "map_covariance", run_index, std::span(covariance));
  file.read(cell, "map_seen", run_index, std::span(seen));
  for (std::size_t k = all - landmarks; k < all; ++k) {
    if (seen[k] == 0.0) continue;
    const double* P = covariance.data() + 4 * k;
    data.rows.push_back(
        ellipse_row(two_sigma_ellipse(mean[2 * k], mean[2 * k + 1], P[0], P[2], P[3])));
  }
  return data;
}

FigureData landmark_data(const ResultFile& file) {
  FigureData data{"landmarks.csv", {"x [m]", "y [m]"}, {}};
  for (const auto& [x, y] : file.landmarks()) data.rows.push_back(texts({x, y}));
  return data;
}

/// Plots of one panel; an empty data file would be an error to gnuplot.
class PanelScript {
 public:
  explicit PanelScript(bool legend) : legend_(legend) {}
  void add(const FigureData& data, const std::string& how, const std::string& title) {
    if (data.rows.empty()) return;
    script_ += (script_.empty() ? "plot " : ", \\\n  ") + gnuplot_quoted("../data/" + data.name) +
               " " + how + (legend_ ? " title " + gnuplot_quoted(title) : " notitle");
  }
  std::string text() const { return script_ + "\n"; }

 private:
  bool legend_;
  std::string script_;
};

/// One cell of the chosen run: truth below, estimate above.
void add_panel(const ResultFile& file, std::size_t cell_index, std::size_t run_index, bool first,
               const FigureData& landmarks, Figure& figure) {
  const StoredCell& cell = file.cells()[cell_index];
  RunRows run;
  RunReader::Scratch scratch;
  RunReader(file, cell).read(run_index, run, scratch);
  figure.data.push_back(path_data(file, cell, run));
  figure.data.push_back(pose_ellipses(cell, run));
  figure.data.push_back(map_data(file, cell, run_index));
  const auto* data = &figure.data[figure.data.size() - 3];
  const std::string style = line_style(cell_index);
  PanelScript panel(first);
  panel.add(data[0], "using 2:3 with lines linewidth 3 linecolor rgb '#aaaaaa'", "true path");
  panel.add(landmarks, "using 1:2 with points pointtype 1 pointsize 0.6 linecolor rgb 'black'",
            "landmark");
  panel.add(data[2], "using 1:2:3:4:5 with ellipses fillstyle empty border " + style,
            "its estimate, 2 sigma");
  panel.add(data[0], "using 4:5 with lines " + style, "estimated path");
  panel.add(data[1], "using 1:2:3:4:5 with ellipses fillstyle empty border " + style,
            "pose, 2 sigma");
  figure.script +=
      "set title " + gnuplot_quoted(cell.label) + " noenhanced offset 0,-0.6\n" + panel.text();
}

std::vector<std::size_t> drawable_cells(const ResultFile& file, std::size_t run_index) {
  std::vector<std::size_t> cells;
  for (std::size_t c = 0; c < file.cells().size() && cells.size() < kMostPanels; ++c) {
    if (file.status(file.cells()[c])[run_index] == RunStatus::complete) cells.push_back(c);
  }
  return cells;
}

}  // namespace

Figure path_figure(const ResultFile& file, std::optional<std::uint64_t> run) {
  Figure figure{"paths", "Where did the filter think it was?", "", 560, 0, "", {}};
  const auto run_index = choose_run(file, run);
  const auto cells = run_index ? drawable_cells(file, *run_index) : std::vector<std::size_t>{};
  if (cells.empty()) return figure;
  const std::size_t columns = cells.size() == 1 ? 1 : 2;
  const std::size_t rows = (cells.size() + columns - 1) / columns;
  figure.height = rows * (columns == 1 ? 460 : 300) + 40;
  figure.sentence = "Run " + std::to_string(file.runs()[*run_index]) +
                    ": the true path in grey, the filter's in colour. Ellipses hold two standard "
                    "deviations: where the filter is honest, the truth is seldom outside.";
  const FigureData landmarks = landmark_data(file);
  figure.script =
      "set size ratio -1\nset style ellipse units xx\nset xlabel 'x [m]'\n"
      "set ylabel 'y [m]'\nset multiplot layout " +
      std::to_string(rows) + "," + std::to_string(columns) + "\n";
  for (std::size_t k = 0; k < cells.size(); ++k) {
    add_panel(file, cells[k], *run_index, k == 0, landmarks, figure);
  }
  figure.script += "unset multiplot\n";
  figure.data.push_back(landmarks);
  return figure;
}

}  // namespace montecarta
