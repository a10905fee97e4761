// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/nees_bounds.hpp"

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

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

/// A number that every run has one of, over runs.
struct Summary {
  std::size_t n = 0;
  double mean = std::numeric_limits<double>::quiet_NaN();
  double sd = std::numeric_limits<double>::quiet_NaN();  ///< of one run, with n - 1

  /// Of the mean.
  double standard_error() const { return sd / std::sqrt(static_cast<double>(n)); }
};

/// Adds up a Summary in the order of the calls (Welford), ignoring nothing: a NaN stays a NaN.
class SummaryOf {
 public:
  void add(double value) {
    ++n_;
    const double before = value - mean_;
    mean_ += before / static_cast<double>(n_);
    squares_ += before * (value - mean_);
  }
  Summary result() const {
    Summary summary;
    summary.n = n_;
    if (n_ > 0) summary.mean = mean_;
    if (n_ > 1) summary.sd = std::sqrt(squares_ / static_cast<double>(n_ - 1));
    return summary;
  }

 private:
  std::size_t n_ = 0;
  double mean_ = 0.0;
  double squares_ = 0.0;
};

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
