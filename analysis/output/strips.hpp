// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/output/figure.hpp"
#include "analysis/statistics/nees_bounds.hpp"

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::analysis {

/// A figure of ratios over time has curves for as many cells as this, and strips, which do not hide
/// each other, for more.
inline constexpr std::size_t kMostRatioCurves = 6;

/// Colours of all levels, as "#b2182b": of ratios from 1/10 to 1000 on a logarithmic scale, blue
/// below 1 and red above it, then the grey of a ratio inside its band.
const std::vector<std::string>& strip_colours();

/// Index in strip_colours(): the last one where the ratio is inside the band, kNoLevel where it is
/// NaN. A ratio beyond an end of the scale has the colour of that end.
int strip_level(double ratio, const Interval& band);

/// What the numbers of the scale say.
inline constexpr const char* kStripScale = "times too large";

/// A number of the scale: at the lower end of a level, or at the end of the scale.
struct StripTick {
  std::size_t level;
  std::string text;
};
const std::vector<StripTick>& strip_ticks();

/// A row of strips: how many times too large or too small something is over time.
struct StripRow {
  std::string name;            ///< of the cell
  std::vector<double> ratios;  ///< one for each place on the common axis; NaN: none
  std::vector<Interval> band;  ///< of a right ratio at each of these places
  std::string note;            ///< at the right end
};

/// Rows of strips over a common axis, mostly time.
struct StripPanel {
  std::string name;    ///< of its data file
  std::string label;   ///< its heading
  std::string inside;  ///< what grey means
  std::string notes;   ///< heading of the notes
  std::vector<StripRow> rows;
};

/// Adds panels of strips one above the other to a figure; nothing where the first has no rows. Of
/// long series, places that share a column show the ratio that is farthest from 1, as a factor,
/// among those outside their band, or among all where none is outside: no excursion is lost.
void add_strips(const std::vector<StripPanel>& panels, const std::vector<double>& places,
                Figure& figure);

/// The strips as boxes that gnuplot draws, one for neighbouring columns of the same colour. Row r
/// from the top has height r: the axis points down.
ChartMarks strip_boxes(const ChartPanel& panel, double x_to);

}  // namespace montecarta::analysis
