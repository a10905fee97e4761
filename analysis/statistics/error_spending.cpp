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

double level_of_analysis(double level, std::span<const std::uint64_t> runs_at_analyses,
                         std::uint64_t runs) {
  if (runs_at_analyses.size() < 2) return level;
  const auto next =
      std::min(std::ranges::lower_bound(runs_at_analyses, runs), runs_at_analyses.end() - 1);
  const auto information = [&](std::uint64_t n) {
    return static_cast<double>(n) / static_cast<double>(runs_at_analyses.back());
  };
  constexpr double kLeastSpent = 1e-10;  // a level nearer to 1 has no exact complement
  const double before =
      next == runs_at_analyses.begin() ? 0.0 : spent(1.0 - level, information(*(next - 1)));
  return 1.0 - std::max(spent(1.0 - level, information(*next)) - before, kLeastSpent);
}

}  // namespace montecarta::analysis
