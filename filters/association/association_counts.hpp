// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/core/slam_filter.hpp"
#include "filters/association/nearest.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace montecarta::filters {

/// What one map's pairings of a scan are, seen with the simulator's eyes. `made_of` {slot}: the
/// identity of the detection that each landmark of the map was made of, before this scan's new
/// ones. Counting only: no estimate may depend on it.
AssociationCounts association_counts(Scan scan, std::span<const Pairing> pairings,
                                     std::span<const std::int32_t> made_of);

/// Adds `share` times the counts of one particle.
void add(const AssociationCounts& counts, double share, AssociationCounts& sum);

/// For every particle and landmark of its map the simulator's identity of the detection that the
/// landmark was made of, to count association errors by. Keeps its memory from run to run.
class InitialisationIdentities {
 public:
  explicit InitialisationIdentities(std::size_t particles)
      : counts_(particles), spare_counts_(particles) {}

  void clear() { std::ranges::fill(counts_, 0U); }
  /// By slot.
  std::span<const std::int32_t> of(std::size_t particle) const {
    return {identities_.data() + particle * room_, counts_[particle]};
  }
  void add(std::size_t particle, std::int32_t identity) {
    if (counts_[particle] == room_) widen();
    identities_[particle * room_ + counts_[particle]++] = identity;
  }
  /// Particle i becomes a copy of particle parents[i].
  void resample(std::span<const std::uint32_t> parents) {
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      std::ranges::copy(of(parents[i]), spare_.begin() + static_cast<std::ptrdiff_t>(i * room_));
      spare_counts_[i] = counts_[parents[i]];
    }
    std::swap(identities_, spare_);
    std::swap(counts_, spare_counts_);
  }

 private:
  void widen() {
    const std::size_t wider = std::max<std::size_t>(16, 2 * room_);
    spare_.assign(counts_.size() * wider, 0);
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      std::ranges::copy(of(i), spare_.begin() + static_cast<std::ptrdiff_t>(i * wider));
    }
    std::swap(identities_, spare_);
    spare_.assign(identities_.size(), 0);
    room_ = wider;
  }

  std::size_t room_ = 0;  ///< landmarks of a particle that fit
  std::vector<std::int32_t> identities_, spare_;
  std::vector<std::uint32_t> counts_, spare_counts_;  ///< {particle} landmarks
};

}  // namespace montecarta::filters
