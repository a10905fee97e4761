// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/survival.hpp"

#include "analysis/statistics/spread.hpp"

#include <boost/math/distributions/normal.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace montecarta::analysis {
namespace {

/// Where a probability lies of which `hits` of `n` were seen.
Interval wilson(double hits, double n, double level) {
  const double z = boost::math::quantile(boost::math::normal(), 0.5 + 0.5 * level);
  const double share = hits / n, scale = 1.0 + z * z / n;
  const double middle = (share + 0.5 * z * z / n) / scale;
  const double half = z * std::sqrt(share * (1.0 - share) / n + 0.25 * z * z / (n * n)) / scale;
  return {std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

}  // namespace

Survival survival_of(std::span<const double> ends, std::span<const double> times, double level) {
  Survival survival;
  survival.runs = ends.size();
  if (ends.empty()) return survival;
  std::vector<double> sorted(ends.begin(), ends.end());
  std::ranges::sort(sorted);
  const auto n = static_cast<double>(sorted.size());
  for (const double time : times) {
    const auto left = static_cast<double>(sorted.end() - std::ranges::upper_bound(sorted, time));
    survival.share.push_back(left / n);
    survival.interval.push_back(wilson(left, n, level));
  }
  survival.lost = static_cast<std::size_t>(
      std::ranges::count_if(sorted, [](double end) { return std::isfinite(end); }));
  survival.median = sorted[(sorted.size() - 1) / 2];
  survival.median_interval = median_interval(sorted, level);
  return survival;
}

}  // namespace montecarta::analysis
