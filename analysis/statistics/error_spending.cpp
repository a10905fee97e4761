// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/error_spending.hpp"

#include "analysis/statistics/distributions.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {

double spent(double alpha, double information) {
  if (!(information > 0.0)) return 0.0;
  return 2.0 * normal_cdf(normal_quantile(0.5 * alpha) / std::sqrt(information));
}

double level_of_look(double level, std::span<const std::uint64_t> looks, std::uint64_t runs) {
  if (looks.size() < 2) return level;
  const auto look = std::min(std::ranges::lower_bound(looks, runs), looks.end() - 1);
  const auto information = [&](std::uint64_t n) {
    return static_cast<double>(n) / static_cast<double>(looks.back());
  };
  constexpr double kLeastSpent = 1e-10;  // a level nearer to 1 has no exact complement
  const double before = look == looks.begin() ? 0.0 : spent(1.0 - level, information(*(look - 1)));
  return 1.0 - std::max(spent(1.0 - level, information(*look)) - before, kLeastSpent);
}

}  // namespace montecarta::analysis
