// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/spread.hpp"

#include "analysis/statistics/distributions.hpp"

#include <boost/math/distributions/binomial.hpp>

#include <algorithm>

namespace montecarta::analysis {
namespace {

bool any_is_nan(std::span<const double> values) {
  return std::ranges::any_of(values, [](double value) { return std::isnan(value); });
}

// These limits come from simulations: of each distribution of heavy_tail_test.cpp, at most 7 % of
// all samples are not said to have a heavy tail and yet have an interval that misses the mean.
constexpr double kMostAcceleration = 0.05, kMostLopsided = 4.0, kOuterShare = 0.1;

/// Interpolated quantile of sorted values: p = 0 is the least one, p = 1 the greatest.
double quantile_between(const std::vector<double>& sorted, double p) {
  const double place = p * static_cast<double>(sorted.size() - 1);
  const auto low = static_cast<std::size_t>(place);
  const std::size_t high = std::min(low + 1, sorted.size() - 1);
  return std::lerp(sorted[low], sorted[high], place - std::floor(place));
}

/// The longer of the two distances from the median to the outer tenths, divided by the shorter; 0
/// if most values are equal.
double lopsidedness(std::vector<double> values) {
  std::ranges::sort(values);
  const double median = quantile_between(values, 0.5);
  const double down = median - quantile_between(values, kOuterShare);
  const double up = quantile_between(values, 1.0 - kOuterShare) - median;
  return std::min(up, down) > 0.0 ? std::max(up, down) / std::min(up, down) : 0.0;
}

}  // namespace

Summary SummaryOf::result() const {
  Summary summary;
  const auto n = static_cast<double>(n_);
  summary.n = n_;
  if (n_ > 0) summary.mean = mean_;
  if (n_ > 1) summary.sd = std::sqrt(squares_ / (n - 1.0));
  if (n_ < 3) return summary;
  const double cube = summary.sd * summary.sd * summary.sd;
  summary.skewness = cube > 0.0 ? cubes_ / cube * (n / ((n - 1.0) * (n - 2.0))) : 0.0;
  return summary;
}

double median_of(std::vector<double> values) {
  if (values.empty() || any_is_nan(values)) return Spread{}.median;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*std::max_element(values.begin(), middle) + *middle);
}

Interval median_interval(const std::vector<double>& sorted, double level) {
  const boost::math::binomial below(static_cast<double>(sorted.size()), 0.5);
  double outside = 0.0;
  std::size_t rank = 0;  // rank of the value at the lower end, counted from 1; 0: there is none
  while (rank < sorted.size() / 2) {
    outside += 2.0 * boost::math::pdf(below, static_cast<double>(rank));
    if (outside > 1.0 - level) break;
    ++rank;
  }
  if (rank == 0) return {kNaN, kNaN};  // even the least and the greatest value hold it too rarely
  return {sorted[rank - 1], sorted[sorted.size() - rank]};
}

double Summary::half_width(double level) const {
  return n < 2 ? kNaN : t_score(level, static_cast<double>(n) - 1.0) * standard_error();
}

Summary summary_of(std::span<const double> values) {
  SummaryOf sums;
  for (const double value : values) sums.add(value);
  return sums.result();
}

Spread spread_of(std::span<const double> values) {
  Spread spread;
  spread.summary = summary_of(values);
  if (values.empty() || any_is_nan(values)) return spread;
  spread.median = median_of({values.begin(), values.end()});
  const auto [least, greatest] = std::ranges::minmax(values);
  spread.least = least;
  spread.greatest = greatest;
  return spread;
}

SampleShape shape_of(std::span<const double> values) {
  const auto n = static_cast<double>(values.size());
  SampleShape shape;
  for (const double value : values) shape.mean += value / n;
  double squares = 0.0, cubes = 0.0;
  for (const double value : values) {
    const double d = value - shape.mean;
    squares += d * d;
    cubes += d * d * d;
  }
  if (squares > 0.0) shape.acceleration = cubes / (6.0 * squares * std::sqrt(squares));
  return shape;
}

bool is_heavy_tailed(std::span<const double> values) {
  const bool finite = std::ranges::all_of(values, [](double v) { return std::isfinite(v); });
  if (!finite || values.size() < 3) return false;
  return std::abs(shape_of(values).acceleration) > kMostAcceleration ||
         lopsidedness({values.begin(), values.end()}) > kMostLopsided;
}

}  // namespace montecarta::analysis
