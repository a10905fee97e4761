// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/summary.hpp"

#include <limits>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// A number of every run, over runs, where few runs may lie far from the others: of a recorded
/// drive runs differ by the filter's randomness alone, and one that loses the map spoils the mean.
struct Spread {
  Summary summary;
  double median = std::numeric_limits<double>::quiet_NaN();
  double least = median;
  double greatest = median;
};

/// The middle value, the mean of the middle two of an even number; NaN of none or of any NaN.
double median_of(std::vector<double> values);

/// `values` in the order of the runs. NaN, all but their number, where one of them is NaN.
Spread spread_of(std::span<const double> values);

}  // namespace montecarta::analysis
