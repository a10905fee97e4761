// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "engine/particles/resampling.hpp"

#include <cstdint>
#include <vector>

namespace montecarta::filters::plain {

/// Parents of the next generation: particle m descends from the first particle with a cumulative
/// weight above (m + U) / M, with one U for all (systematic) or one for each (stratified)
/// (EQUATIONS 18).
inline std::vector<std::uint32_t> parents_by(Resampling scheme, const std::vector<double>& weights,
                                             const StepContext& context) {
  std::vector<std::uint32_t> parents(weights.size());
  std::size_t parent = 0;
  double cumulative = weights[0];
  for (std::uint32_t m = 0; m < parents.size(); ++m) {
    const std::uint32_t index = scheme == Resampling::systematic ? 0 : m;
    const double U = context.stream(Draw::resampling, index).uniform();
    const double u = (m + U) / static_cast<double>(weights.size());
    while (cumulative <= u && parent + 1 < weights.size()) cumulative += weights[++parent];
    parents[m] = static_cast<std::uint32_t>(parent);
  }
  return parents;
}

}  // namespace montecarta::filters::plain
