// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/output/figure.hpp"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// [px] the width of most characters, in either font.
inline constexpr double kCharacter = 7.8;

/// Position of a panel in a printed chart [px], from the upper left corner.
struct PanelBox {
  double left = 0.0, right = 0.0, top = 0.0, bottom = 0.0;
  bool is_lowest = true;  ///< of its column: has the numbers of the horizontal axis
  bool is_alone_in_row = true;
  bool has_heading = true;  ///< its label stands above it, else beside its axis
  double x_from = 0.0, x_to = 0.0;
};

/// Panels in rows of chart.columns below a legend. A chart that begins zoomed has every panel twice
/// in a row: whole, and zoomed.
struct PrintLayout {
  double height = 0.0;          ///< [px] of the drawing
  std::vector<PanelBox> boxes;  ///< `views` for each panel
  std::size_t views = 1;
};

PrintLayout print_layout(const Chart& chart, double width, double legend_height);

/// Runs gnuplot on the script `name` in `directory`, which is its working directory. Throws
/// StudyError if gnuplot is not installed, and RunError with its message if it fails. `program` is
/// looked up in PATH.
void run_gnuplot(const std::filesystem::path& directory, const std::string& name,
                 const std::string& program = "gnuplot");

/// A text constant of gnuplot: quoted, printed as it stands.
std::string gnuplot_quoted(const std::string& text);

/// Data and plot commands of a panel's bands, curves and marks.
struct PanelPlots {
  std::string numbers;   ///< data blocks
  std::string commands;  ///< behind "plot"
};

PanelPlots panel_plots(const Chart& chart, std::size_t panel);

/// Styles for plots and legends, behind "with".
std::string band_style();
std::string curve_style(std::size_t style);
std::string mark_style(const ChartMarks& marks);

/// [px] of strip_key().
inline constexpr std::size_t kStripKeyHeight = 42;

/// Commands that draw the colour scale of strips, above them in place of a legend. It is aligned
/// with the strips in `box` if there is room in a drawing of this size [px].
std::string strip_key(const ChartStrips& strips, const PanelBox& box, double width, double height);

/// A chart as gnuplot draws it.
struct GnuplotChart {
  std::string numbers;     ///< data blocks, once for all terminals
  std::string commands;    ///< behind terminal and style
  std::size_t height = 0;  ///< [px]
};

/// `width` [px].
GnuplotChart gnuplot_chart(const Chart& chart, std::size_t width);

}  // namespace montecarta::analysis
