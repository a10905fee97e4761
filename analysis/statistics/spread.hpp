// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/interval.hpp"

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <tuple>
#include <vector>

namespace montecarta::analysis {

/// Stands for a missing number.
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Sum in index order; NaN without values.
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

/// Summary over runs of a number that each run has.
struct Summary {
  std::size_t n = 0;
  double mean = std::numeric_limits<double>::quiet_NaN();
  /// Standard deviation of one run, with n - 1.
  double sd = std::numeric_limits<double>::quiet_NaN();
  /// Third standardised moment of one run, corrected for the number of runs; 0 if all values are
  /// equal, NaN below three values.
  double skewness = std::numeric_limits<double>::quiet_NaN();

  /// Standard error of the mean.
  double standard_error() const { return sd / std::sqrt(static_cast<double>(n)); }
  /// Half the width of Student's interval of the mean; NaN below two values.
  double half_width(double level) const;
  Interval interval(double level) const {
    const double half = half_width(level);
    return {mean - half, mean + half};
  }
};

/// Adds up values to a Summary in the order of the calls (Welford). No value is ignored: after a
/// NaN the results are NaN.
class SummaryOf {
 public:
  void add(double value) {
    ++n_;
    const double before = value - mean_, n = static_cast<double>(n_), step = before / n;
    cubes_ += step * (step * before * (n - 1.0) * (n - 2.0) - 3.0 * squares_);
    mean_ += step;
    squares_ += before * (value - mean_);
  }
  /// Adds the sums over the values that follow (Chan, Golub and LeVeque 1979; Pebay 2008).
  void merge(const SummaryOf& next) {
    if (next.n_ == 0) return;
    if (n_ == 0) {
      *this = next;
      return;
    }
    const auto n = static_cast<double>(n_), more = static_cast<double>(next.n_);
    const double difference = next.mean_ - mean_, share = difference / (n + more);
    cubes_ += next.cubes_ + share * (share * difference * n * more * (n - more) +
                                     3.0 * (n * next.squares_ - more * squares_));
    n_ += next.n_;
    mean_ += difference * (more / (n + more));
    squares_ += next.squares_ + difference * difference * (n * more / (n + more));
  }
  static constexpr auto members() {
    return std::tuple(&SummaryOf::n_, &SummaryOf::mean_, &SummaryOf::squares_, &SummaryOf::cubes_);
  }
  Summary result() const;

 private:
  std::size_t n_ = 0;
  double mean_ = 0.0;
  double squares_ = 0.0;  ///< sum of squared deviations from the mean
  double cubes_ = 0.0;    ///< sum of cubed deviations from the mean
};

/// The summary of `values`, added in their order.
Summary summary_of(std::span<const double> values);

/// Summary over runs of a number that each run has, for studies in which few runs may lie far from
/// the others: runs on a recorded drive differ by the filter's randomness alone, and one that loses
/// the map spoils the mean.
struct Spread {
  Summary summary;
  double median = std::numeric_limits<double>::quiet_NaN();
  double least = median;
  double greatest = median;
};

/// The median: the middle value, or the mean of the middle two. NaN without values or if one is
/// NaN.
double median_of(std::vector<double> values);

/// Interval between two of the `sorted` values that holds the median over infinitely many values
/// with a probability of at least `level`, by order statistics: no distribution is assumed. NaN if
/// there are too few values: the range of n values holds the median with the probability 1 - 2^(1 -
/// n), which is below 95 % for fewer than six values.
Interval median_interval(const std::vector<double>& sorted, double level);

/// Spread of `values` in the order of the runs. NaN, except their number, if one of them is NaN.
Spread spread_of(std::span<const double> values);

/// Mean of a sample, and skewness divided by 6 sqrt(n), the rate at which the spread of a mean
/// changes with the mean.
struct SampleShape {
  double mean = 0.0;
  double acceleration = 0.0;
};

/// Mean and acceleration of BCa (STATISTICS 6) of finite values; the acceleration is 0 if all are
/// equal.
SampleShape shape_of(std::span<const double> values);

/// Returns whether the values have such a heavy tail that no interval of their mean is valid
/// (STATISTICS 6): a single value may decide the mean, or values of that size may not have been
/// drawn yet. True for nearly all samples of a log-normal distribution with a deviation of 1.5; for
/// half of the samples of size 20, and 7 % of those of size 100, of an exponential distribution;
/// never for fewer than three values, for equal values, or if a value is not finite.
bool is_heavy_tailed(std::span<const double> values);

}  // namespace montecarta::analysis
