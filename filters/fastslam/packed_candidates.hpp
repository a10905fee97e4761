// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/particles/blocks.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace montecarta::filters {

/// How the candidates of the particles of one block share registers, so that none is spent on lanes
/// without a particle: candidate `member` of the particle in `lane` is number member * particles
/// + lane. With all lanes alive nothing changes place.
template <class Real>
class PackedCandidates {
 public:
  /// `particles` <= kLanesOf<Real> particles of `members` candidates each.
  PackedCandidates(std::size_t particles, std::size_t members)
      : particles_(particles),
        numbers_(particles * members),
        lanes_of_(std::lcm(particles, kLanes)),
        place_of_(blocks_for<Real>(numbers_) * kLanes) {
    for (std::size_t i = 0; i < lanes_of_.size(); ++i)
      lanes_of_[i] = static_cast<std::uint32_t>(i % particles);
    for (std::size_t i = 0; i < place_of_.size(); ++i) {
      const std::size_t member = i < numbers_ ? i / particles : 0;  // what fills up is nobody's
      place_of_[i] = static_cast<std::uint32_t>(member * kLanes + i % particles);
    }
  }

  std::size_t blocks() const { return place_of_.size() / kLanes; }
  /// After how many packed blocks lanes belong to the same particles again.
  std::size_t patterns() const { return lanes_of_.size() / kLanes; }

  /// What is said of the particles of a block, as the lanes of packed block `pattern`, `pattern` +
  /// patterns(), ... need it. `Block`: a struct of Reals.
  template <class Block>
  Block pattern_of(const Block& particles, std::size_t pattern) const {
    if (particles_ == kLanes) return particles;
    return gather_block<Real, Block>(std::span(&particles, 1), lanes_of_, pattern);
  }
  /// Packed block q of candidates of which each holds one of every lane.
  template <class Candidate>
  Candidate pack(std::span<const Candidate> candidates, std::size_t q) const {
    if (particles_ == kLanes) return candidates[q];
    return gather_block<Real, Candidate>(candidates, place_of_, q);
  }
  /// Puts the numbers of packed block q where their candidates came from.
  void unpack(const Real& packed, std::size_t q, std::span<Real> numbers) const {
    if (particles_ == kLanes) {
      numbers[q] = packed;
      return;
    }
    for (std::size_t i = q * kLanes; i < std::min((q + 1) * kLanes, numbers_); ++i)
      set(numbers[place_of_[i] / kLanes], place_of_[i] % kLanes, get(packed, i % kLanes));
  }

 private:
  static constexpr std::size_t kLanes = kLanesOf<Real>;

  std::size_t particles_;                ///< lanes that hold a particle
  std::size_t numbers_;                  ///< of candidates
  std::vector<std::uint32_t> lanes_of_;  ///< the particle of every packed lane, until they repeat
  std::vector<std::uint32_t> place_of_;  ///< member and lane of every packed candidate
};

}  // namespace montecarta::filters
