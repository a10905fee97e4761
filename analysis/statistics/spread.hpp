// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/means.hpp"
#include "analysis/statistics/nees_bounds.hpp"

#include <cstddef>
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

/// The two of `sorted`, one or more values, between which the median over infinitely many lies with
/// probability `level` at least, by order statistics: no distribution is assumed.
Interval median_interval(const std::vector<double>& sorted, double level);

/// `values` in the order of the runs. NaN, all but their number, where one of them is NaN.
Spread spread_of(std::span<const double> values);

/// Two-sided quantile of Student's t with n - 1 degrees of freedom, n > 1.
double t_quantile(std::size_t n, double level);

/// Whether no interval of the mean of such values is to be trusted (STATISTICS 6): a single value
/// may decide the mean, or values of that size may lie where none was drawn yet. Of a log-normal
/// with a deviation of 1.5 nearly always, of an exponential in half of samples of 20 and in 7 % of
/// samples of 100; never of fewer than three values, of equal ones or where one is not finite.
bool is_heavy_tailed(std::span<const double> values);

}  // namespace montecarta::analysis
