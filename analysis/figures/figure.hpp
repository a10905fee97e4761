// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/figures/chart.hpp"
#include "analysis/figures/thinning.hpp"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace montecarta {

/// A file of numbers that a figure draws: headings with units, and rows.
struct FigureData {
  std::string name;  ///< of the file below data/, e.g. "anees.csv"
  std::vector<std::string> headings;
  std::vector<std::vector<double>> rows;
};

/// A figure before it is drawn.
struct Figure {
  std::string name;      ///< of its files, e.g. "anees"
  std::string title;     ///< a heading on the page
  std::string sentence;  ///< what it means, for someone who sees such a figure for the first time
  std::size_t width = 900;   ///< [px] 18 cm in print: the text width of a journal's page
  std::size_t height = 360;  ///< [px]
  std::string script;        ///< gnuplot commands behind terminal and style; data lies in ../data/
  std::vector<FigureData> data;
  Chart chart = {};  ///< the same once more, where it is curves over a common axis
};

/// Writes figures/<name>.gp and data/ below `directory` and draws figures/<name>.svg and .pdf.
void draw(const Figure& figure, const std::filesystem::path& directory);

/// Line colour of curve `i`, "#0072B2": told apart by the colour-blind (Okabe and Ito).
std::string line_colour(std::size_t i);
/// How curve `i` is dashed, from 1, a full line: from the seventh on curves differ by that.
std::size_t line_dashes(std::size_t i);
/// Both for gnuplot.
std::string line_style(std::size_t i);
/// In place of the number of a curve: of what is no cell, such as a bound; dashed, in the colour of
/// the text.
inline constexpr std::size_t kYardstickStyle = static_cast<std::size_t>(-1);
/// Of the truth, below what filters think of it; for charts.
inline constexpr std::size_t kTruthStyle = static_cast<std::size_t>(-2);

/// The data file of curves over what `heading` says.
FigureData data_of(const std::string& name, const std::string& heading,
                   const ThinnedSeries& thinned);

}  // namespace montecarta
