// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/output/chart.hpp"
#include "analysis/output/csv_file.hpp"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// Series over one common time, short enough to draw.
struct ThinnedSeries {
  std::vector<double> times;  ///< [s]
  std::vector<NamedSeries> series;
};

/// Leaves at most 2 x `buckets` values of each series: the least and the greatest of every stretch
/// of time, in the order in which they occur, so no peak is lost. Times are those of the stretch's
/// beginning and middle. A stretch without a number stays NaN. Short series come back as they are.
ThinnedSeries thin(std::span<const double> times, const std::vector<NamedSeries>& series,
                   std::size_t buckets);

/// A file of the numbers behind a figure: headings with units, and rows.
struct FigureData {
  std::string name;  ///< of the file below data/, e.g. "anees.csv"
  std::vector<std::string> headings;
  std::vector<std::vector<double>> rows;
};

/// A figure: one chart, drawn by gnuplot and by the page.
struct Figure {
  std::string name;                   ///< of its files, e.g. "anees"
  std::string title;                  ///< a heading on the page
  std::string sentence;               ///< what it means, for someone who never saw such a figure
  std::vector<FigureData> data = {};  ///< its numbers; none: it is left out
  Chart chart = {};
  std::size_t width = 900;  ///< [px] 18 cm in print: the text width of a journal's page
};

/// Writes figures/<name>.gp and data/ below `directory` and draws figures/<name>.svg and .pdf.
void draw(const Figure& figure, const std::filesystem::path& directory);

/// The data file of curves over what `heading` says.
FigureData data_of(const std::string& name, const std::string& heading,
                   const ThinnedSeries& thinned);

/// A curve of a panel.
struct Curve {
  std::string legend;          ///< empty: none
  std::size_t style = 0;       ///< for line_colour()
  std::vector<double> values;  ///< one for each place on the common axis
};

/// The vertical axis.
enum class Scale {
  from_zero,
  percent,  ///< 0 to 100
  logarithmic,
  automatic,   ///< logarithmic where the values span more than a factor of 30, else from zero
  around_zero  ///< as far below zero as above
};

/// Axes with curves over a common axis, mostly time.
struct Panel {
  std::string name;   ///< of its data file
  std::string label;  ///< of the vertical axis, with unit
  std::vector<Curve> curves;
  std::vector<Band> bands;
  Scale scale = Scale::from_zero;
  double least = 0.0;  ///< a logarithmic axis begins here at the earliest
};

/// Adds panels one above the other, with one horizontal axis and one legend, to a figure; nothing
/// where the first has no curves. The axis is called as the figure's chart says.
void add_panels(const std::vector<Panel>& panels, const std::vector<double>& places,
                Figure& figure);

}  // namespace montecarta::analysis
