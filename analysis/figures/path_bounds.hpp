// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/output/figure.hpp"

#include <limits>
#include <vector>

namespace montecarta::analysis {

/// A rectangle of the plane [m].
struct Bounds {
  double left = std::numeric_limits<double>::infinity(), right = -left;
  double low = left, high = -left;

  /// What is not a number, or beyond any map (1e100 m), has no place.
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

/// Of paths (data "path_...") with their truth, and landmarks.
Bounds path_bounds(const std::vector<FigureData>& all);
/// Of a recorded drive. A filter that is lost may be anywhere: paths and maps (data "path_...",
/// "map_...") reach no farther than a quarter beyond the fixes.
Bounds recorded_bounds(const std::vector<FigureData>& all, const FigureData& fixes,
                       const FigureData& landmarks);

}  // namespace montecarta::analysis
