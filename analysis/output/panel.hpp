// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/output/figure.hpp"

#include <string>
#include <vector>

namespace montecarta::analysis {

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
