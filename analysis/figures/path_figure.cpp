// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/figures/path_figure.hpp"

#include "analysis/figures/gnuplot.hpp"
#include "analysis/figures/path_data.hpp"
#include "analysis/run_reader.hpp"
#include "analysis/tables/number_text.hpp"
#include "engine/errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace montecarta {
namespace {

constexpr std::size_t kMostPanels = 8;
constexpr std::size_t kLegendPixels = 32;
constexpr std::size_t kRowGapPixels = 44;  // below a row: ticks and label of a short last row

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

/// The rectangle that all paths and landmarks lie in.
struct Bounds {
  double left = std::numeric_limits<double>::infinity(), right = -left;
  double low = left, high = -left;

  void include(double x, double y) {
    if (!std::isfinite(x) || !std::isfinite(y)) return;
    left = std::min(left, x);
    right = std::max(right, x);
    low = std::min(low, y);
    high = std::max(high, y);
  }
  /// Room around, and no axis shorter than a quarter of the other.
  Bounds widened() const {
    const double width = right - left, height = high - low;
    const double room = 0.05 * std::max(width, height) + 1e-3;
    const double x = room + std::max(0.0, 0.25 * height - width) / 2.0;
    const double y = room + std::max(0.0, 0.25 * width - height) / 2.0;
    Bounds wide;
    wide.include(left - x, low - y);
    wide.include(right + x, high + y);
    return wide;
  }
};

/// Plots of one panel; an empty data file would be an error to gnuplot.
class PanelScript {
 public:
  void add(const FigureData& data, const std::string& how) {
    if (data.rows.empty()) return;
    script_ += (script_.empty() ? "plot " : ", \\\n  ") + gnuplot_quoted("../data/" + data.name) +
               " " + how + " notitle";
  }
  std::string text() const { return script_ + "\n"; }

 private:
  std::string script_;
};

constexpr const char* kTruth = "with lines linewidth 3 linecolor rgb '#aaaaaa'";
constexpr const char* kLandmark = "with points pointtype 1 pointsize 0.6 linecolor rgb 'black'";

/// Adds the data of one cell of the chosen run and returns its plot: truth below, estimate above.
std::string add_panel(const ResultFile& file, std::size_t cell_index, std::size_t run_index,
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
  const std::string ellipses = "using 1:2:3:4:5 with ellipses fillstyle empty border " + style;
  PanelScript panel;
  panel.add(data[0], std::string("using 2:3 ") + kTruth);
  panel.add(landmarks, std::string("using 1:2 ") + kLandmark);
  panel.add(data[2], ellipses);
  panel.add(data[0], "using 4:5 with lines " + style);
  panel.add(data[1], ellipses);
  return "set title " + gnuplot_quoted(cell.label) + " noenhanced offset 0,-0.5\n" + panel.text();
}

Bounds bounds_of(const std::vector<FigureData>& all) {
  Bounds bounds;
  for (const FigureData& data : all) {
    const bool is_path = data.name.starts_with("path_");
    if (!is_path && data.name != "landmarks.csv") continue;
    for (const auto& row : data.rows) {
      for (std::size_t c = is_path ? 1 : 0; c + 1 < row.size(); c += 2) {
        bounds.include(row[c], row[c + 1]);
      }
    }
  }
  return bounds.widened();
}

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

/// Panels of equal size side by side, wrapped beyond three, the legend in a strip of its own above;
/// sets the figure's height.
std::string layout_of(std::size_t panels, const Bounds& bounds, Figure& figure) {
  const Columns columns(panels);
  const std::size_t rows = (panels + columns.count - 1) / columns.count;
  const double aspect = (bounds.high - bounds.low) / (bounds.right - bounds.left);
  const std::size_t title = 24, axis = 66;
  const auto panel =
      static_cast<std::size_t>(static_cast<double>(figure.width) * columns.panel() * aspect);
  figure.height = kLegendPixels + axis + rows * (panel + title) + (rows - 1) * kRowGapPixels;
  const auto share = [&](std::size_t pixels) {
    return readable(static_cast<double>(pixels) / static_cast<double>(figure.height), 5);
  };
  return axes_of(bounds) + "set multiplot layout " + std::to_string(rows) + "," +
         std::to_string(columns.count) + " margins " + readable(columns.left, 5) + "," +
         readable(columns.right, 5) + "," + share(axis) + "," +
         share(figure.height - kLegendPixels - title) + " spacing " + readable(columns.gap, 5) +
         "," + share(title + kRowGapPixels) + "\n";
}

/// A plot of nothing across the whole figure, for its legend: that of a panel is no wider than the
/// panel.
std::string legend_plot(const Figure& figure) {
  const double bottom =
      1.0 - static_cast<double>(kLegendPixels) / static_cast<double>(figure.height);
  const auto entry = [](const std::string& how, const char* title) {
    return "keyentry " + how + " title " + gnuplot_quoted(title) + ", \\\n  ";
  };
  return "set size noratio\nset lmargin at screen 0\nset rmargin at screen 1\n"
         "set tmargin at screen 1\nset bmargin at screen " +
         readable(bottom, 5) +
         "\nunset title\nunset xlabel\nunset ylabel\nunset border\nunset tics\nunset grid\n"
         "set key inside center center horizontal Left reverse\nplot [0:1] [0:1] " +
         entry(kTruth, "true path") + entry(kLandmark, "landmark") +
         entry("with lines " + line_style(0), "estimate") +
         entry("with points pointtype 6 pointsize 1.2 " + line_style(0), "2 sigma") +
         "NaN notitle\n";
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

std::vector<std::size_t> drawable_cells(const ResultFile& file, std::size_t run_index) {
  std::vector<std::size_t> cells;
  for (std::size_t c = 0; c < file.cells().size() && cells.size() < kMostPanels; ++c) {
    if (file.status(file.cells()[c])[run_index] == RunStatus::complete) cells.push_back(c);
  }
  return cells;
}

}  // namespace

Figure path_figure(const ResultFile& file, std::optional<std::uint64_t> run) {
  Figure figure{"paths", "Where did the filter think it was?", "", 900, 0, "", {}};
  const auto run_index = choose_run(file, run);
  const auto cells = run_index ? drawable_cells(file, *run_index) : std::vector<std::size_t>{};
  if (cells.empty()) return figure;
  figure.sentence = "Run " + std::to_string(file.runs()[*run_index]) +
                    ": the true path in grey, the filter's in colour. Ellipses hold two standard "
                    "deviations of the pose, at " +
                    std::to_string(kPoseEllipses) +
                    " moments, and of landmarks at the end: where the filter is honest, the truth "
                    "is seldom outside.";
  const FigureData landmarks = landmark_data(file);
  std::string panels;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    panels += labels_of(k, cells.size()) + add_panel(file, cells[k], *run_index, landmarks, figure);
  }
  figure.data.push_back(landmarks);
  figure.script = layout_of(cells.size(), bounds_of(figure.data), figure) + panels;
  figure.script += legend_plot(figure) + "unset multiplot\n";
  return figure;
}

}  // namespace montecarta
