// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace montecarta {

/// A horizontal band, e.g. where a right filter stays. It keeps the vertical axis near: from 0.3
/// times its lower end to 1000 times its upper one at most, so that it is seen beside a filter that
/// is off by many powers of ten.
struct Band {
  std::string legend;
  double lower = 0.0;
  double upper = 0.0;  ///< may be infinite: no end above
};

/// A vertical axis.
struct ChartAxis {
  bool logarithmic = false;
  double low = 0.0;
  double high = 0.0;  ///< NaN: as far as the curves reach
};

/// Axes with curves, ready to draw.
struct ChartPanel {
  struct Curve {
    std::string legend;          ///< curves of one legend are one cell: a page hides them together
    std::size_t style = 0;       ///< for line_style()
    std::vector<double> values;  ///< one for each of `x`; NaN: a gap
  };
  std::string label;  ///< of the vertical axis, with unit
  ChartAxis axis;
  std::vector<double> x;  ///< increasing
  std::vector<Curve> curves;
  std::vector<Band> bands;
};

/// What a figure's drawing shows, as numbers: a page with scripts draws it again, to be zoomed into
/// and asked. Panels lie one above the other over one horizontal axis.
struct Chart {
  std::string x_label = "time [s]";
  double x_from = 0.0, x_to = 0.0;
  std::vector<ChartPanel> panels;  ///< none: the figure has its drawing alone
};

}  // namespace montecarta
