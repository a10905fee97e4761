// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/random/normals.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace montecarta {

/// Where evolve() takes its random numbers from: lane l uses the stream of index identity.index +
/// l, from block `first_block` on; whoever asks may have used the blocks before it.
struct EvolutionDraws {
  StreamIdentity identity;
  std::uint32_t first_block = 0;
};

namespace evolution {

/// Three members that differ from each other and from the target.
using Members = std::array<std::uint32_t, 3>;

/// Splits a uniform number in (0, 1): a digit in {0, ..., count - 1}, and another uniform number
/// out of the bits it did not use.
inline std::uint32_t take_digit(double& uniform, std::size_t count) {
  uniform *= static_cast<double>(count);
  const double digit = std::min(std::floor(uniform), static_cast<double>(count - 1));
  uniform -= digit;
  return static_cast<std::uint32_t>(digit);
}

/// r1, r2 (from `first`) and r0 (from `second`): all different and none `target`; `size` >= 3. With
/// three members there is no third one, and r0 is not to be used.
inline Members draw_members(std::size_t size, std::uint32_t target, double& first, double& second) {
  std::uint32_t r1 = take_digit(first, size - 1);
  r1 += r1 >= target;
  const std::uint32_t low = std::min(r1, target), high = std::max(r1, target);
  std::uint32_t r2 = take_digit(first, size - 2);
  r2 += r2 >= low;
  r2 += r2 >= high;
  if (size == 3) return {r1, r2, 0};
  const std::uint32_t least = std::min(low, r2), most = std::max(high, r2);
  std::uint32_t r0 = take_digit(second, size - 3);
  r0 += r0 >= least;
  r0 += r0 >= low + high + r2 - least - most;
  r0 += r0 >= most;
  return {r1, r2, r0};
}

/// What one trial needs to know of chance.
template <class Real, std::size_t D>
struct TrialDraws {
  static constexpr std::uint32_t kBlocks = (2 + D + 1) / 2;  ///< of the stream
  std::array<Members, kLanesOf<Real>> members;               ///< r1, r2, r0 of each lane
  std::array<Real, D> crosses;  ///< in (0, 1); -1 for the component that crosses in any case

  TrialDraws(const EvolutionDraws& draws, std::uint32_t block, std::size_t size,
             std::size_t target) {
    std::array<Real, 2 * kBlocks> uniform;
    for (std::uint32_t k = 0; k < kBlocks; ++k) {
      const auto pair = uniform_pairs(draws.identity, draws.first_block + block + k, Real());
      uniform[2 * k] = pair.first;
      uniform[2 * k + 1] = pair.second;
    }
    std::copy_n(uniform.begin() + 2, D, crosses.begin());
    for (std::size_t lane = 0; lane < kLanesOf<Real>; ++lane) {
      double first = get(uniform[0], lane), second = get(uniform[1], lane);
      members[lane] = draw_members(size, static_cast<std::uint32_t>(target), first, second);
      set(crosses[take_digit(second, D)], lane, -1.0);
    }
  }
};

}  // namespace evolution
}  // namespace montecarta
