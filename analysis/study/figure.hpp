// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/frame.hpp"
#include "analysis/study/prose.hpp"

#include <cstddef>
#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace montecarta::analysis {

/// Style of reference curves that belong to no cell, such as a bound: dashed, in the colour of the
/// text.
inline constexpr std::size_t kReferenceStyle = static_cast<std::size_t>(-1);
/// Style of the truth, drawn below the estimates.
inline constexpr std::size_t kTruthStyle = static_cast<std::size_t>(-2);

/// Line colour of curve `i`, "#0072B2", from a palette for colour-blind readers (Okabe and Ito).
std::string line_colour(std::size_t i);
/// Dash pattern of curve `i`; 1 is a full line. From the seventh curve on, colours repeat with
/// another pattern.
std::size_t line_dashes(std::size_t i);

/// A horizontal band, e.g. of a consistent filter. The vertical axis is limited to the range from
/// 0.3 times its lower end to 100 000 times its upper end, so that the band stays visible beside a
/// filter that is off by many powers of ten.
struct Band {
  std::string legend;
  double lower = 0.0;
  double upper = 0.0;
};

/// A vertical axis.
struct ChartAxis {
  bool logarithmic = false;
  double low = 0.0;   ///< value at the bottom
  double high = 0.0;  ///< value at the top; NaN: the largest value of the curves
};

/// Marks with their own coordinates instead of the panel's common x. The page shows the facts of
/// the mark nearest to the pointer.
struct ChartMarks {
  enum class Shape { line, points, crosses, ellipses };
  /// A number of each mark.
  struct Fact {
    std::string label;  ///< name of the fact, with unit
    std::vector<double> values;
  };
  std::string name;       ///< kind of the marks
  std::string cell;       ///< cell with which the marks are hidden; empty: always shown
  std::size_t style = 0;  ///< style index for line_colour()
  Shape shape = Shape::line;
  double thickness = 0.0;             ///< [px] thickness of lines and points; 0: the usual one
  std::vector<double> x, y;           ///< coordinates; NaN makes a gap in a line
  std::vector<double> width, height;  ///< diameters of ellipses
  std::vector<double> angle;          ///< [deg] angle of ellipses
  std::vector<Fact> facts;            ///< facts that the page shows; may be empty
};

/// Rows of colours for ratios of errors to their expectation, from top to bottom (strips.hpp).
struct ChartStrips {
  static constexpr int kNoLevel = -1;
  struct Row {
    std::string name;            ///< label of the cell
    std::vector<double> ratios;  ///< {column} NaN if there is none
    std::vector<int> levels;     ///< {column} index in strip_colours(); kNoLevel if there is none
    std::string note;            ///< text at the right end
  };
  std::vector<Row> rows;
  std::string inside;  ///< meaning of the grey level
  std::string notes;   ///< heading of the notes
};

/// A curve of a panel.
struct Curve {
  std::string legend;          ///< curves of one legend are one cell: a page hides them together
  std::size_t style = 0;       ///< style index for line_colour()
  std::vector<double> values;  ///< {place on the common axis} NaN makes a gap
  /// {place} half the width of an envelope around zero, such as three standard deviations; empty if
  /// there is none.
  std::vector<double> envelope = {};
};

/// Axes with curves, ready to draw.
struct ChartPanel {
  std::string label;  ///< label of the vertical axis, with unit
  ChartAxis axis;
  std::vector<double> x;  ///< coordinates on the horizontal axis, increasing
  std::vector<Curve> curves;
  std::vector<Band> bands;
  std::string cell = {};  ///< label of the only cell, with which the panel is hidden
  std::vector<ChartMarks> marks = {};
  /// The columns of a figure without curves. Column k extends from x[k] to x[k + 1], the last one
  /// to Chart::x_to.
  ChartStrips strips = {};
  /// Names of the places 0, 1, ... of the vertical axis, from top to bottom, instead of numbers.
  std::vector<std::string> names = {};
};

/// Contents of a figure, drawn by gnuplot for print and by the page's script for the screen. All
/// panels have the same horizontal axis.
struct Chart {
  std::string x_label = "time [s]";
  double x_from = 0.0, x_to = 0.0;
  std::vector<ChartPanel> panels;
  /// Left end of the view before the reader zooms; NaN: x_from.
  double x_first = std::numeric_limits<double>::quiet_NaN();
  /// Panels side by side, if there is room; else they are one above the other.
  std::size_t columns = 1;
  std::size_t least = 0;  ///< [px] least width of a panel
  double aspect = 0.0;    ///< height of a panel divided by its width; 0: the usual one
  double height = 0.0;  ///< [px] height of a panel in print, if it has no aspect; 0: the usual one
  bool is_map = false;  ///< whether both directions have one scale, at any zoom
  bool x_logarithmic = false;
  /// Names of the places 0, 1, ... of the horizontal axis, instead of numbers.
  std::vector<std::string> x_names = {};
};

/// Thins a frame to at most 2 x `buckets` values of each column: the least and the greatest of
/// every stretch, in the order in which they occur, so no peak is lost. The first column, which
/// increases, defines the stretches; of it the beginning and the middle of each stretch are kept. A
/// stretch without a number stays NaN. A short frame is returned unchanged.
Frame thin(const Frame& frame, std::size_t buckets);

/// A file of the numbers behind a figure.
struct FigureData {
  std::string name;  ///< name of the file below data/, e.g. "anees.csv"
  Frame frame = {};
};

/// A figure: one chart, drawn by gnuplot and by the page.
struct Figure {
  std::string name;      ///< name of its files, e.g. "anees"
  std::string title;     ///< a heading on the page
  std::string sentence;  ///< explanation for readers who are new to such a figure
  /// Numbers behind the figure, which is left out if there are none.
  std::vector<FigureData> data = {};
  Chart chart = {};
  std::size_t width = 900;  ///< [px] width: 18 cm in print, the text width of a journal's page
};

/// A figure without data, with the texts below `## figure name` in a file of prose: the title and,
/// unless the caller sets it, the sentence.
Figure figure_of(std::string_view name, const Values& values = {});

/// Kind of the vertical axis.
enum class Scale {
  from_zero,
  percent,  ///< from 0 to 100
  logarithmic,
  automatic,   ///< logarithmic if the values span more than a factor of 30, else from zero
  around_zero  ///< zero is in the middle
};

/// Axes with curves over a common axis, mostly time.
struct Panel {
  std::string name;   ///< name of its data file
  std::string label;  ///< label of the vertical axis, with unit
  std::vector<Curve> curves;
  std::vector<Band> bands;
  Scale scale = Scale::from_zero;
  double least = 0.0;  ///< lower limit of a logarithmic axis
};

/// Adds panels, one above the other, with one horizontal axis and one legend, to a figure; none if
/// the first has no curves. The figure's chart has the label of the axis.
void add_panels(const std::vector<Panel>& panels, const std::vector<double>& places,
                Figure& figure);

}  // namespace montecarta::analysis
