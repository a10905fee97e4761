// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/figures/figure.hpp"

#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace montecarta {

/// A rectangle of the plane [m].
struct Bounds {
  double left = std::numeric_limits<double>::infinity(), right = -left;
  double low = left, high = -left;

  /// What is not a number has no place.
  void include(double x, double y);
  bool empty() const { return left > right; }
  /// Room around, and no axis shorter than a quarter of the other.
  Bounds widened() const;
  /// `share` of the longer side farther in every direction.
  Bounds grown(double share) const;
  bool contains(double x, double y) const {
    return x >= left && x <= right && y >= low && y <= high;
  }
};

/// An entry of a legend: how gnuplot draws it, and its words.
using LegendEntry = std::pair<std::string, std::string>;

/// The script of a figure of maps, one panel for each of `panels` (a title and a plot), of equal
/// size and scale within `bounds`, side by side and wrapped beyond three, the legend in a strip of
/// its own above; sets the figure's height.
void lay_out_maps(const Bounds& bounds, const std::vector<std::string>& panels,
                  const std::vector<LegendEntry>& legend, Figure& figure);

}  // namespace montecarta
