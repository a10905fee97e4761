// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/figure.hpp"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// Position of a panel in a printed chart [px], from the upper left corner.
struct PanelBox {
  double left = 0.0, right = 0.0, top = 0.0, bottom = 0.0;
  /// Whether the panel is the lowest of its column and has the numbers of the horizontal axis.
  bool is_lowest = true;
  bool is_alone_in_row = true;
  bool has_heading = true;  ///< whether the label is above the panel, not beside it
  double x_from = 0.0, x_to = 0.0;
};

/// Panels in rows of chart.columns below a legend. A chart that begins zoomed has every panel twice
/// in a row: whole and zoomed.
struct PrintLayout {
  double height = 0.0;          ///< [px] height of the drawing
  std::vector<PanelBox> boxes;  ///< `views` boxes for each panel
  std::size_t views = 1;
};

PrintLayout print_layout(const Chart& chart, double width, double legend_height);

/// Runs one gnuplot on `scripts` in their order, with all settings reset between them, in
/// `directory` as its working directory. Throws StudyError if gnuplot is not installed, and
/// RunError with gnuplot's message if it fails. `program` is looked up in PATH.
void run_gnuplot(const std::filesystem::path& directory, const std::vector<std::string>& scripts,
                 const std::string& program = "gnuplot");

/// A text as a quoted constant of gnuplot, which prints it unchanged.
std::string gnuplot_quoted(const std::string& text);

/// A chart as gnuplot draws it.
struct GnuplotChart {
  std::string numbers;     ///< text of the data blocks, which all terminals share
  std::string commands;    ///< commands that follow those for terminal and style
  std::size_t height = 0;  ///< [px] height of the drawing
};

/// Makes the commands for a chart of `width` [px].
GnuplotChart gnuplot_chart(const Chart& chart, std::size_t width);

/// Writes figures/<name>.gp and data/ below `directory`, and draws figures/<name>.svg and .pdf, all
/// by one gnuplot, which takes longer to start than to draw.
void draw(std::span<const Figure* const> figures, const std::filesystem::path& directory);

}  // namespace montecarta::analysis
