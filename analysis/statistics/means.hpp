// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>
#include <span>

namespace montecarta::analysis {

/// Where there is no number.
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// In index order; NaN of none.
template <class Values>
double sum_of(const Values& values) {
  if (values.empty()) return kNaN;
  double sum = 0.0;
  for (const auto value : values) sum += static_cast<double>(value);
  return sum;
}
template <class Values>
double mean_of(const Values& values) {
  return sum_of(values) / static_cast<double>(values.size());
}

/// Mean of the finite values, in index order; NaN where there is none.
inline double mean_of_finite(std::span<const double> values) {
  double sum = 0.0, n = 0.0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    sum += value;
    n += 1.0;
  }
  return sum / n;
}

}  // namespace montecarta::analysis
