// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/spread.hpp"

#include <boost/math/distributions/binomial.hpp>

#include <algorithm>

namespace montecarta::analysis {
namespace {

bool is_nan(double value) { return std::isnan(value); }

}  // namespace

double median_of(std::vector<double> values) {
  if (values.empty() || std::ranges::any_of(values, is_nan)) return Spread{}.median;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*std::max_element(values.begin(), middle) + *middle);
}

Interval median_interval(const std::vector<double>& sorted, double level) {
  const boost::math::binomial below(static_cast<double>(sorted.size()), 0.5);
  double outside = 0.0;
  std::size_t rank = 0;  // how many values are cut off at either end
  while (rank < sorted.size() / 2) {
    outside += 2.0 * boost::math::pdf(below, static_cast<double>(rank));
    if (outside > 1.0 - level) break;
    ++rank;
  }
  const std::size_t first = rank == 0 ? 0 : rank - 1;
  return {sorted[first], sorted[sorted.size() - 1 - first]};
}

Spread spread_of(std::span<const double> values) {
  Spread spread;
  SummaryOf sums;
  for (const double value : values) sums.add(value);
  spread.summary = sums.result();
  if (values.empty() || std::ranges::any_of(values, is_nan)) return spread;
  spread.median = median_of({values.begin(), values.end()});
  const auto [least, greatest] = std::ranges::minmax(values);
  spread.least = least;
  spread.greatest = greatest;
  return spread;
}

}  // namespace montecarta::analysis
