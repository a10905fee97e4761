// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/interval.hpp"
#include "analysis/study/figure.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// The largest number of cells for which a figure of ratios over time has curves. For more cells it
/// has strips, which do not cover each other.
inline constexpr std::size_t kMostRatioCurves = 6;

/// Colours of all levels, as "#b2182b": for ratios from 1/10 to 1000 on a logarithmic scale, blue
/// below 1 and red above it, then the grey of a ratio inside its band.
const std::vector<std::string>& strip_colours();

/// Index in strip_colours(): the last one where the ratio is inside the band, kNoLevel where it is
/// NaN. A ratio beyond an end of the scale has the colour of that end.
int strip_level(double ratio, const Interval& band);

/// Label of the colour scale.
inline constexpr const char* kStripScale = "times too large";

/// A number beside the scale, at the lower end of a level or at the end of the scale.
struct StripTick {
  std::size_t level;
  std::string text;
};
const std::vector<StripTick>& strip_ticks();

/// A row of strips: the ratio of errors to their expectation over time.
struct StripRow {
  std::string name;            ///< label of the cell
  std::vector<double> ratios;  ///< {place on the common axis} NaN if there is none
  std::vector<Interval> band;  ///< {place} band of the ratio of a consistent filter
  std::string note;            ///< text at the right end
};

/// Rows of strips over a common axis, mostly time.
struct StripPanel {
  std::string name;    ///< name of its data file
  std::string label;   ///< heading of the panel
  std::string inside;  ///< meaning of the grey level
  std::string notes;   ///< heading of the notes
  std::vector<StripRow> rows;
};

/// Adds panels of strips, one above the other, to a figure; none if the first has no rows. If
/// several places of a long series share a column, the column shows the ratio farthest from 1, as a
/// factor, among those outside their band, or among all if none is outside, so that no excursion is
/// lost.
void add_strips(const std::vector<StripPanel>& panels, const std::vector<double>& places,
                Figure& figure);

/// Strips as boxes that gnuplot draws, one for each sequence of columns of the same colour. Row r
/// from the top has y = r: the axis points down.
struct StripBoxes {
  std::vector<double> x, y;  ///< middle of each box
  std::vector<double> width, height;
  std::vector<double> colour;  ///< 0xRRGGBB as a number
};
StripBoxes strip_boxes(const ChartPanel& panel, double x_to);

}  // namespace montecarta::analysis
