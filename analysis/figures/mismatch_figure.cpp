// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/figures/mismatch_figure.hpp"

#include "analysis/figures/gnuplot.hpp"
#include "analysis/mismatch/mismatch.hpp"
#include "analysis/tables/number_text.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta {
namespace {

constexpr std::size_t kMostColumns = 3, kRowPixels = 330, kColumnPixels = 330;

/// Blue, white and red (ColorBrewer's RdBu, safe for the colour-blind), light enough for dark
/// numbers at both ends; 1 is white, ten times and a tenth are the ends.
constexpr const char* kColours =
    "set palette defined (-1 '#4393c3', -0.5 '#a6cfe3', 0 '#f7f7f7', 0.5 '#f6b799', 1 '#d6604d')\n"
    "set style fill solid 1 noborder\n"
    "set cbrange [-1:1]\n"
    "set cbtics ('0.1' -1, '0.3' -0.5229, '1' 0, '3' 0.4771, '10' 1)\n"
    "set cblabel 'ANEES / components'\n";

FigureData data_of(const MismatchGrid& grid) {
  FigureData data{"mismatch_" + grid.family + ".csv",
                  {"motion_noise", "sensor_noise", "anees_per_component", "column", "row",
                   "log10 of anees_per_component, from -1 to 1"},
                  {}};
  for (Eigen::Index m = 0; m < grid.anees.rows(); ++m) {
    for (Eigen::Index s = 0; s < grid.anees.cols(); ++s) {
      const double anees = grid.anees(m, s);
      if (std::isnan(anees)) continue;
      data.rows.push_back({grid.motion_noise[static_cast<std::size_t>(m)],
                           grid.sensor_noise[static_cast<std::size_t>(s)], anees,
                           static_cast<double>(m), static_cast<double>(s),
                           std::clamp(std::log10(anees), -1.0, 1.0)});
    }
  }
  return data;
}

/// Ticks that name the factors at 0, 1, 2, ...
std::string axis_of(const char* axis, const std::vector<double>& factors) {
  std::string ticks;
  for (std::size_t i = 0; i < factors.size(); ++i) {
    ticks +=
        (i == 0 ? "" : ", ") + gnuplot_quoted(exact_text(factors[i])) + " " + std::to_string(i);
  }
  return std::string("set ") + axis + "tics (" + ticks + ")\nset " + axis +
         "range [-0.5:" + exact_text(static_cast<double>(factors.size()) - 0.5) + "]\n";
}

std::string panel_of(const MismatchGrid& grid) {
  const std::string file = gnuplot_quoted("../data/mismatch_" + grid.family + ".csv");
  return "set title " + gnuplot_quoted(grid.family) + " noenhanced\n" +
         axis_of("x", grid.motion_noise) + axis_of("y", grid.sensor_noise) + "plot " + file +
         " using 4:5:($4-0.49):($4+0.49):($5-0.49):($5+0.49):6 with boxxyerror fillcolor palette "
         "fillstyle solid 1 noborder notitle, \\\n  " +
         file +
         " using 4:5:(sprintf($3 < 1000 ? '%.3g' : '%.0f', $3)) with labels textcolor rgb "
         "'#111111' notitle\n";
}

}  // namespace

Figure mismatch_figure(const StudyAnalysis& study) {
  Figure figure{"mismatch", "What if the filter is told wrong noise?", "", 900, 0, "", {}};
  figure.sentence =
      "Each square is one filter that believes the noise of motion (to the right) and of the "
      "sensor "
      "(upwards) to be so many times what the study tells; its number is ANEES by components, mean "
      "over scans. 1 is white: the filter knows how wrong it is. Red, above 1: too sure of itself; "
      "blue, below 1: too cautious. Colours end at a tenth and at ten times.";
  const std::vector<MismatchGrid> grids = mismatch_grids(study);
  if (grids.empty()) return figure;
  const std::size_t columns = std::min(kMostColumns, grids.size());
  const std::size_t rows = (grids.size() + columns - 1) / columns;
  figure.width = std::max<std::size_t>(420, columns * kColumnPixels);
  figure.height = rows * kRowPixels;
  figure.script = std::string(kColours) +
                  "set xlabel 'motion noise, believed by told'\n"
                  "set ylabel 'sensor noise, believed by told'\nunset grid\nset multiplot layout " +
                  std::to_string(rows) + "," + std::to_string(columns) + "\n";
  for (const MismatchGrid& grid : grids) {
    figure.script += panel_of(grid);
    figure.data.push_back(data_of(grid));
  }
  figure.script += "unset multiplot\n";
  return figure;
}

}  // namespace montecarta
