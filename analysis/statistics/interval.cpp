// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/interval.hpp"

#include "engine/text/number_text.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {
namespace {

/// Text of a mean with its interval, to the second significant digit of the interval's half width
/// and to `least` significant digits of the mean or more.
std::string with_digits(double mean, const Interval& interval, int least) {
  const auto magnitude = [](double value) {
    return static_cast<int>(std::floor(std::log10(std::abs(value))));
  };
  const double half = 0.5 * (interval.upper - interval.lower);
  if (std::isnan(mean) || !std::isfinite(half) || half <= 0.0) return compact(mean);
  const int of_mean = least > 0 && mean != 0.0 ? least - 1 - magnitude(mean) : 0;
  const int decimals = std::max({0, 1 - magnitude(half), of_mean});
  constexpr double kSmall = 1e-4;  // below it, zeros would take more room than digits
  const bool is_small = std::max(std::abs(interval.lower), std::abs(interval.upper)) < kSmall;
  const auto each = [&](double value) {
    if (std::abs(mean) >= 1e4) return compact(value);
    if (is_small || decimals > 12) return readable(value, 2);
    return with_error_to(decimals, value, std::nan(""));
  };
  return each(mean) + " [" + each(interval.lower) + ", " + each(interval.upper) + "]";
}

}  // namespace

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
  return with_digits(mean, interval, 0);
}

std::string ratio_with_interval(double ratio, const Interval& interval) {
  return with_digits(ratio, interval, 3);
}

}  // namespace montecarta::analysis
