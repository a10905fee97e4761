// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/figure.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// Five quantiles of a sample, which a box shows: whiskers at 5 and 95 %, quartiles, median.
struct FiveNumbers {
  double low = 0.0, lower_quartile = 0.0, median = 0.0, upper_quartile = 0.0, high = 0.0;
};

/// The five quantiles (quantile_of()) of at least one value, none NaN (STATISTICS 25).
FiveNumbers five_numbers(std::vector<double> values);

/// The values of the runs of one cell.
struct BoxRow {
  std::string name;       ///< label of the cell
  std::size_t style = 0;  ///< style index for line_colour()
  std::vector<double> values;
};

/// Adds one box for each row to a figure, from top to bottom over a common axis with the label
/// `x_label`. Values that are not finite are left out; a row without values has no box. The axis
/// is logarithmic if the boxes span more than a factor of 30.
void add_boxes(const std::vector<BoxRow>& rows, const std::string& x_label, Figure& figure);

}  // namespace montecarta::analysis
