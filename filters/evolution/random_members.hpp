// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/random/normals.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace montecarta::filters {

/// Where evolve() takes its random numbers from: lane l uses the stream of index identity.index +
/// l, from block `first_block` on; whoever asks may have used the blocks before it.
struct EvolutionDraws {
  StreamIdentity identity;
  std::uint32_t first_block = 0;
};

namespace evolution {

/// Three members that differ from each other and from the target, as whole numbers, lane by lane.
template <class Real>
using Members = std::array<Real, 3>;

/// Splits a uniform number in (0, 1): a digit in {0, ..., count - 1}, and another uniform number
/// out of the bits it did not use.
template <class Real>
Real take_digit(Real& uniform, std::size_t count) {
  const Real stretched = uniform * Real(static_cast<double>(count));
  const Real digit = min(floor(stretched), Real(static_cast<double>(count - 1)));
  uniform = stretched - digit;
  return digit;
}

/// r1, r2 (from `first`) and r0 (from `second`): all different and none `target`; `size` >= 3. With
/// three members there is no third one, and r0 is not to be used.
template <class Real>
Members<Real> draw_members(std::size_t size, std::size_t target, Real& first, Real& second) {
  const auto leave_out = [](const Real& member, const Real& taken) {  // in rising order
    return select(member >= taken, Real(member + Real(1.0)), member);
  };
  const Real t(static_cast<double>(target));
  const Real r1 = leave_out(take_digit(first, size - 1), t);
  const Real low = min(r1, t), high = max(r1, t);
  const Real r2 = leave_out(leave_out(take_digit(first, size - 2), low), high);
  if (size == 3) return {r1, r2, Real(0.0)};
  const Real least = min(low, r2), most = max(high, r2), middle = low + high + r2 - least - most;
  const Real r0 = take_digit(second, size - 3);
  return {r1, r2, leave_out(leave_out(leave_out(r0, least), middle), most)};
}

/// What one trial needs to know of chance.
template <class Real, std::size_t D>
struct TrialDraws {
  static constexpr std::uint32_t kBlocks = (2 + D + 1) / 2;  ///< of the stream
  Members<Real> members;                                     ///< r1, r2, r0
  std::array<Real, D> crosses;  ///< in (0, 1); -1 for the component that crosses in any case

  TrialDraws(const EvolutionDraws& draws, std::uint32_t block, std::size_t size,
             std::size_t target) {
    std::array<Real, 2 * kBlocks> uniform;
    for (std::uint32_t k = 0; k < kBlocks; ++k) {
      const auto pair = uniform_pairs(draws.identity, draws.first_block + block + k, Real());
      uniform[2 * k] = pair.first;
      uniform[2 * k + 1] = pair.second;
    }
    members = draw_members(size, target, uniform[0], uniform[1]);
    const Real crossing = take_digit(uniform[1], D);
    for (std::size_t j = 0; j < D; ++j) {
      crosses[j] = select(crossing == Real(static_cast<double>(j)), Real(-1.0), uniform[2 + j]);
    }
  }
};

}  // namespace evolution
}  // namespace montecarta::filters
