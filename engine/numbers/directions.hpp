// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/numbers/real.hpp"

#include <array>
#include <cstddef>

namespace montecarta::engine {

/// The unit vectors at a few angles [rad], computed together: not much dearer than one.
template <std::size_t N>
[[gnu::always_inline]] inline std::array<Direction<double>, N> directions_of(
    const std::array<double, N>& angles) {
  static_assert(N <= Lanes::kSize);
  constexpr std::size_t size = Lanes::Register::size;
  std::array<Direction<double>, N> directions;
  for (std::size_t first = 0; first < N; first += size) {
    Lanes::Register angle(0.0), sine, cosine;
    for (std::size_t k = first; k < N && k < first + size; ++k) angle.data[k - first] = angles[k];
    register_math::sincos(angle, sine, cosine);
    for (std::size_t k = first; k < N && k < first + size; ++k)
      directions[k] = {cosine.data[k - first], sine.data[k - first]};
  }
  return directions;
}

}  // namespace montecarta::engine
