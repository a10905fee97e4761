// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/heavy_tail.hpp"

#include "analysis/statistics/bootstrap.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace montecarta::analysis {
namespace {

// Simulated so that of each distribution of heavy_tail_test.cpp at most 7 % of all samples are not
// said to have a heavy tail and have an interval that misses the mean.
constexpr double kMostAcceleration = 0.05, kMostLopsided = 4.0, kOuterShare = 0.1;

/// Between its neighbours, the extreme ones at 0 and 1.
double quantile_between(const std::vector<double>& sorted, double p) {
  const double place = p * static_cast<double>(sorted.size() - 1);
  const auto low = static_cast<std::size_t>(place);
  const std::size_t high = std::min(low + 1, sorted.size() - 1);
  return std::lerp(sorted[low], sorted[high], place - std::floor(place));
}

/// The longer by the shorter of the ways from the median to the outer tenths; 0 of values that are
/// mostly the same.
double lopsidedness(std::vector<double> values) {
  std::ranges::sort(values);
  const double median = quantile_between(values, 0.5);
  const double down = median - quantile_between(values, kOuterShare);
  const double up = quantile_between(values, 1.0 - kOuterShare) - median;
  return std::min(up, down) > 0.0 ? std::max(up, down) / std::min(up, down) : 0.0;
}

}  // namespace

bool is_heavy_tailed(std::span<const double> values) {
  const bool finite = std::ranges::all_of(values, [](double v) { return std::isfinite(v); });
  if (!finite || values.size() < 3) return false;
  return std::abs(shape_of(values).acceleration) > kMostAcceleration ||
         lopsidedness({values.begin(), values.end()}) > kMostLopsided;
}

}  // namespace montecarta::analysis
