// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
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

}  // namespace montecarta::analysis
