// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/quantile.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace montecarta::analysis {

double quantile_of(std::vector<double>& values, double p) {
  const auto last = static_cast<double>(values.size() - 1);
  const double place = std::clamp(p * (last + 1.0) - 0.5, 0.0, last);
  const auto low = values.begin() + static_cast<std::ptrdiff_t>(place);
  std::ranges::nth_element(values, low);
  const auto high = low + 1 == values.end() ? low : std::min_element(low + 1, values.end());
  return std::lerp(*low, *high, place - std::floor(place));
}

}  // namespace montecarta::analysis
