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

}  // namespace montecarta::analysis
