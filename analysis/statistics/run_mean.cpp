// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/run_mean.hpp"

#include "analysis/statistics/distributions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kFewestRuns = 3;     // fewest runs that have a skewness
constexpr double kLeastSkewness = 1e-6;    // below this skewness the transformation is the identity
constexpr double kMostDeviations = 1e100;  // limit for means of runs that hardly differ
constexpr double kRounding = 1e-9;         // rounding error of a mean that is zero

/// Corrections of the skewness of a sample. It is too small, since a sample of `n` hardly ever
/// holds the tail that makes a law skewed: inflation() multiplies it. It is also uncertain: its
/// standard error for normal values is added or subtracted on the side on which fewer means are
/// rejected.
double inflation(double n) { return 1.0 + 1.0 / std::sqrt(n); }
double standard_error_of_skewness(double n) { return std::sqrt(6.0 / n); }

}  // namespace

// A gamma distribution has the skewness 2 sd / mean.
RunMean RunMean::of_ratio(const Summary& runs, double common_skewness) {
  const auto n = static_cast<double>(runs.n);
  const double least = runs.mean > 0.0 ? 2.0 * runs.sd / runs.mean : 0.0;
  const double own = std::max(runs.skewness, common_skewness);
  return {runs, std::max(runs.skewness - standard_error_of_skewness(n), least),
          std::max(own * inflation(n) + standard_error_of_skewness(n), least), true};
}

RunMean RunMean::of_product(const Summary& runs) {
  const auto n = static_cast<double>(runs.n);
  const double skewness = runs.skewness * inflation(n), error = standard_error_of_skewness(n);
  return {runs, std::min(0.0, skewness - error), std::max(0.0, skewness + error), false};
}

RunMean RunMean::of_symmetric(const Summary& runs) { return {runs, 0.0, 0.0, false}; }

RunMean RunMean::in_units_of(double unit, double offset) const {
  RunMean scaled = *this;
  scaled.runs_.mean = (scaled.runs_.mean - offset) / unit;
  scaled.runs_.sd /= unit;
  return scaled;
}

// Hall's transformation, (5.1) of STATISTICS, is flat where 1 + g x / 3 is 0. It ends there, since
// a sample that far on the side of its short tail says nothing about the long tail.
double RunMean::score(double expected) const {
  const auto n = static_cast<double>(runs_.n);
  const double difference = runs_.mean - expected;
  if (std::abs(difference) < (is_ratio_ ? 0.0 : kRounding) || difference == 0.0) return 0.0;
  if (runs_.sd == 0.0) return std::copysign(std::numeric_limits<double>::infinity(), difference);
  const double x = std::clamp(difference / runs_.sd, -kMostDeviations, kMostDeviations);
  const double g = x > 0.0 ? skewness_above_ : skewness_below_;
  if (std::abs(g) < kLeastSkewness) return std::sqrt(n) * x;
  const double root = std::max(0.0, 1.0 + g * x / 3.0);
  return std::sqrt(n) * ((root * root * root - 1.0) / g + g / (6.0 * n));
}

double RunMean::expectation_at(double score) const {
  const auto n = static_cast<double>(runs_.n);
  const double g = score > 0.0 ? skewness_above_ : skewness_below_;
  const double by_root_n = score / std::sqrt(n);
  if (std::abs(g) < kLeastSkewness) return runs_.mean - runs_.sd * by_root_n;
  const double cube = 1.0 + g * (by_root_n - g / (6.0 * n));
  if (cube <= 0.0) return std::copysign(std::numeric_limits<double>::infinity(), -score);
  return runs_.mean - runs_.sd * (std::cbrt(cube) - 1.0) * 3.0 / g;
}

double RunMean::p_value(double expected) const {
  if (runs_.n < kFewestRuns) return 1.0;
  const auto n = static_cast<double>(runs_.n);
  const double p = t_p_value(score(expected), n - 1.0);
  if (!is_ratio_) return p;
  const double squares = n * runs_.mean / expected;
  return std::min(
      {p, 2.0 * chi_squared_cdf(kFar * squares, n), 2.0 * chi_squared_tail(squares / kFar, n)});
}

double RunMean::p_value_above_zero() const { return runs_.mean > 0.0 ? 0.5 * p_value(0.0) : 1.0; }

Interval RunMean::interval(double level) const {
  if (runs_.n < kFewestRuns) return {kNaN, kNaN};
  const auto n = static_cast<double>(runs_.n);
  if (runs_.sd == 0.0) return {runs_.mean, runs_.mean};
  const double score = t_score(level, n - 1.0);
  Interval found{expectation_at(score), expectation_at(-score)};
  if (!is_ratio_) return found;
  const double tail = 0.5 * (1.0 - level), squares = n * runs_.mean;
  found.lower = std::max(found.lower, squares / kFar / chi_squared_beyond(tail, n));
  found.upper = std::min(found.upper, kFar * squares / chi_squared_quantile(tail, n));
  return found;
}

}  // namespace montecarta::analysis
