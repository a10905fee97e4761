// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/interval.hpp"

#include "engine/text/number_text.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {

std::vector<double> ends_of(const std::vector<Interval>& intervals, double Interval::*end) {
  std::vector<double> ends;
  for (const Interval& interval : intervals) ends.push_back(interval.*end);
  return ends;
}

std::string interval_text(const Interval& interval) {
  if (std::isnan(interval.lower)) return "-";
  return "[" + readable(interval.lower) + ", " + readable(interval.upper) + "]";
}

std::string with_interval(double mean, const Interval& interval) {
  const double half = 0.5 * (interval.upper - interval.lower);
  if (std::isnan(mean) || !std::isfinite(half) || half <= 0.0) return compact(mean);
  const int decimals = std::max(0, 1 - static_cast<int>(std::floor(std::log10(half))));
  constexpr double kSmall = 1e-4;  // below it, zeros would take more room than digits
  const bool is_small = std::max(std::abs(interval.lower), std::abs(interval.upper)) < kSmall;
  const auto each = [&](double value) {
    if (std::abs(mean) >= 1e4) return compact(value);
    if (is_small || decimals > 12) return readable(value, 2);
    return with_error_to(decimals, value, std::nan(""));
  };
  return each(mean) + " [" + each(interval.lower) + ", " + each(interval.upper) + "]";
}

}  // namespace montecarta::analysis
