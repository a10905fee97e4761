// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/moments.hpp"

#include <algorithm>

namespace montecarta::analysis {

bool is_drawn(const RunRows& rows, std::size_t s) {
  const std::vector<double>&spread = rows.spread.covariance, &mixture = rows.mixture.covariance;
  if (mixture.empty()) return true;
  const auto first = static_cast<std::ptrdiff_t>(9 * s);
  return !std::equal(spread.begin() + first, spread.begin() + first + 9, mixture.begin() + first);
}

EffectiveDraws draws_at(const RunRows& rows, std::size_t particles, std::size_t s) {
  return effective_draws(particles,
                         rows.ess.empty() ? static_cast<double>(particles) : rows.ess[s]);
}

}  // namespace montecarta::analysis
