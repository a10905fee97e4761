// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <tuple>
#include <vector>

namespace montecarta::analysis {

/// A closed interval. Functions return NaN for both ends if there is none.
struct Interval {
  double lower = 0.0;
  double upper = 0.0;
  static constexpr auto members() { return std::tuple(&Interval::lower, &Interval::upper); }
};

/// The lower or upper ends of `intervals`; `end` is `&Interval::lower` or `&Interval::upper`.
std::vector<double> ends_of(const std::vector<Interval>& intervals, double Interval::*end);

/// Text of an interval, "[3.38, 3.79]"; "-" where there is no interval.
std::string interval_text(const Interval& interval);

/// Text of a mean with its interval, "3.58 [3.38, 3.79]", with all numbers to the second
/// significant digit of the interval's half width; the mean alone where there is no interval.
std::string with_interval(double mean, const Interval& interval);

/// Text of a ratio with its interval, likewise, but with three significant digits of the ratio or
/// more: "1.96 [1.61, 24.21]".
std::string ratio_with_interval(double ratio, const Interval& interval);

}  // namespace montecarta::analysis
