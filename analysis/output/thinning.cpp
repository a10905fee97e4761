// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/thinning.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace montecarta::analysis {
namespace {

/// Least and greatest number of a stretch, the earlier one first; NaN where there is none.
std::array<double, 2> extremes(std::span<const double> values) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::array<double, 2> found = {nan, nan};  // least, greatest
  std::array<std::size_t, 2> at = {0, 0};
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i])) continue;
    if (!(values[i] >= found[0])) std::tie(found[0], at[0]) = std::pair(values[i], i);
    if (!(values[i] <= found[1])) std::tie(found[1], at[1]) = std::pair(values[i], i);
  }
  if (at[1] < at[0]) std::swap(found[0], found[1]);
  return found;
}

}  // namespace

ThinnedSeries thin(std::span<const double> times, const std::vector<NamedSeries>& series,
                   std::size_t buckets) {
  if (times.size() <= 2 * buckets) return {{times.begin(), times.end()}, series};
  ThinnedSeries thinned;
  for (const NamedSeries& one : series) thinned.series.push_back({one.name, one.units, {}});
  for (std::size_t b = 0; b < buckets; ++b) {
    const std::size_t begin = b * times.size() / buckets;
    const std::size_t end = (b + 1) * times.size() / buckets;
    thinned.times.push_back(times[begin]);
    thinned.times.push_back(times[(begin + end) / 2]);
    for (std::size_t i = 0; i < series.size(); ++i) {
      const std::span<const double> stretch(series[i].values.data() + begin, end - begin);
      for (const double value : extremes(stretch)) thinned.series[i].values.push_back(value);
    }
  }
  return thinned;
}

}  // namespace montecarta::analysis
