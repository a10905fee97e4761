// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/output/chart.hpp"

#include <cstddef>
#include <vector>

namespace montecarta::analysis {

/// Where a panel lies in a printed chart [px], from the upper left corner.
struct PanelBox {
  double left = 0.0, right = 0.0, top = 0.0, bottom = 0.0;
  bool is_lowest = true;  ///< of its column: has the numbers of the horizontal axis
  bool is_alone_in_row = true;
  bool has_heading = true;  ///< its label stands above it, else beside its axis
  double x_from = 0.0, x_to = 0.0;
};

/// Panels in rows of chart.columns below a legend. A chart that begins zoomed has every panel twice
/// in a row: whole, and zoomed.
struct PrintLayout {
  double height = 0.0;          ///< [px] of the drawing
  std::vector<PanelBox> boxes;  ///< `views` for each panel
  std::size_t views = 1;
};

PrintLayout print_layout(const Chart& chart, double width, double legend_height);

}  // namespace montecarta::analysis
