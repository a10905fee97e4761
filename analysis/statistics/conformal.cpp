// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/conformal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace montecarta::analysis {
namespace {

/// ceil((n + 1) level), of which rounding makes no larger number.
std::size_t rank_of_bound(std::size_t n, double level) {
  constexpr double kRounding = 1e-9;
  const double share = static_cast<double>(n + 1) * level;
  return static_cast<std::size_t>(std::ceil(share - kRounding));
}

}  // namespace

double conformal_bound(std::vector<double> values, double level) {
  const std::size_t rank = rank_of_bound(values.size(), level);
  if (rank > values.size()) return std::numeric_limits<double>::infinity();
  std::ranges::sort(values);
  return values[rank == 0 ? 0 : rank - 1];
}

std::size_t fewest_for_bound(double level) {
  std::size_t n = 1;
  while (rank_of_bound(n, level) > n) ++n;
  return n;
}

}  // namespace montecarta::analysis
