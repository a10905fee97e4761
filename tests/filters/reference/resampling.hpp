// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/step_context.hpp"
#include "tests/filters/reference/fast_slams.hpp"

#include <cstdint>
#include <vector>

namespace montecarta::filters::reference {

/// Parents of the next generation: particle m descends from the first whose cumulated weight
/// exceeds u_m = (m + U) / M, one U for all (systematic) or one each (stratified) (EQUATIONS 18).
inline std::vector<std::uint32_t> draw_parents(Scheme scheme, const std::vector<double>& weights,
                                               const StepContext& context) {
  std::vector<std::uint32_t> parents(weights.size());
  std::size_t parent = 0;
  double cumulated = weights[0];
  for (std::uint32_t m = 0; m < parents.size(); ++m) {
    const std::uint32_t index = scheme == Scheme::systematic ? 0 : m;
    const double U = context.stream(Draw::resampling, index).uniform();
    const double u = (m + U) / static_cast<double>(weights.size());
    while (cumulated <= u && parent + 1 < weights.size()) cumulated += weights[++parent];
    parents[m] = static_cast<std::uint32_t>(parent);
  }
  return parents;
}

}  // namespace montecarta::filters::reference
