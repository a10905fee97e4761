// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/figures/path_bounds.hpp"
#include "analysis/output/figure.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// What is drawn of one cell: files of path_data.hpp, those without rows are left out.
struct DrawnPath {
  std::string label;
  std::size_t style = 0;  ///< for line_colour()
  FigureData path, poses, map;
};

/// A map for each cell, with the true landmarks and the fixes of the reference on all of them.
Chart path_chart(const std::vector<DrawnPath>& cells, const FigureData& landmarks,
                 const FigureData& fixes, const Bounds& bounds);

}  // namespace montecarta::analysis
