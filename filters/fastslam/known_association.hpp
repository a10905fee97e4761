// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/core/slam_filter.hpp"
#include "engine/particles/weights.hpp"
#include "filters/fastslam/particle_maps.hpp"
#include "filters/moments/correlated_map.hpp"
#include "filters/moments/linearised.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace montecarta {

/// Detections carry the identity of their landmark, the same for all particles (EQUATIONS 17);
/// clutter is known to be clutter. Slots are given out in the order in which landmarks are first
/// seen.
template <class Real>
class KnownAssociation {
 public:
  explicit KnownAssociation(std::size_t landmarks) : slot_of_(landmarks, kUnseen) {}

  void clear() { std::fill(slot_of_.begin(), slot_of_.end(), kUnseen); }

  /// Sorts the scan into known and new landmarks.
  template <class Predicted, class Expected>
  void associate(const StepContext& /*context*/, Scan scan, ParticleMaps<Real>& maps,
                 const Predicted& /*predicted*/, const Expected& /*expected*/) {
    slots_.clear(), seen_.clear(), new_.clear();
    for (const Detection& detection : scan) {
      if (detection.identity == Detection::kClutter) continue;
      const std::int32_t slot = slot_of_.at(static_cast<std::size_t>(detection.identity));
      if (slot == kUnseen) {
        new_.push_back(detection);
      } else {
        slots_.push_back(static_cast<std::uint32_t>(slot));
        seen_.push_back(sight_of<Real>(detection));
      }
    }
    maps.open(slots_, opened_);
  }

  bool found_nothing() const { return slots_.empty() && new_.empty(); }
  std::size_t matches() const { return slots_.size(); }
  /// The weight of the particles that matched detection k: all.
  double matched_weight(std::size_t /*k*/, const Weights<Real>& /*weights*/) const { return 1.0; }

  /// visit(k, landmark, seen, mask) for every match of block b; the first visit of a scan.
  template <class Visit>
  [[gnu::always_inline]] void read(std::size_t b, const Visit& visit) const {
    for (std::size_t k = 0; k < slots_.size(); ++k)
      visit(k, opened_[k].fetch(b), seen_[k], Everywhere());
  }
  /// visit(k, landmark, seen, mask), which may change the landmark; after read().
  template <class Visit>
  [[gnu::always_inline]] void update(std::size_t b, const Visit& visit) const {
    for (std::size_t k = 0; k < slots_.size(); ++k)
      visit(k, opened_[k].at(b), seen_[k], Everywhere());
  }
  /// visit(slot) for the landmarks of all matches.
  template <class Visit>
  void each_slot(const Visit& visit) const {
    for (const std::uint32_t slot : slots_) visit(slot);
  }
  /// Block b of a slot of a match.
  const LandmarkGaussian<Real>& landmark_in(std::uint32_t slot, std::size_t b) const {
    const auto found = std::find(slots_.begin(), slots_.end(), slot);
    return opened_[static_cast<std::size_t>(found - slots_.begin())].fetch(b);
  }
  /// Which landmark of a correlated map match k is; index_of(slot) says where that holds a slot.
  template <class IndexOf>
  ForAll where(std::size_t /*b*/, std::size_t k, const IndexOf& index_of) const {
    return {index_of(slots_[k])};
  }
  /// Nobody errs: clutter is left out, all else goes where it belongs.
  AssociationCounts counts(const Weights<Real>& /*weights*/) const {
    return {.correct = static_cast<double>(slots_.size() + new_.size())};
  }
  /// Landmarks of a map; every particle has as many.
  double map_size(const ParticleMaps<Real>& maps, const Weights<Real>& /*weights*/) const {
    return static_cast<double>(maps.slots());
  }
  /// All particles explain the same detections, so there is nothing to make equal.
  Real unmatched_log_weight(std::size_t /*b*/) const { return Real(0.0); }

  /// Gives every new landmark a slot, filled by birth(block, seen); then settled(block, slot,
  /// put), where put(from, to) copies the lanes it is new for.
  template <class Birth, class Settled>
  void add_new(ParticleMaps<Real>& maps, const Birth& birth, const Settled& settled) {
    for (const Detection& detection : new_) {
      const std::uint32_t slot = maps.add();
      slot_of_[static_cast<std::size_t>(detection.identity)] = static_cast<std::int32_t>(slot);
      const auto blocks = maps.blocks_of(slot);
      for (std::size_t b = 0; b < blocks.size(); ++b) {
        blocks[b] = birth(b, sight_of<Real>(detection));
        settled(b, slot, [](const auto& from, auto& to) { to = from; });
      }
    }
  }
  void resample(std::span<const std::uint32_t> /*parents*/) {}

  /// The slot of the landmark with this identity, or kUnseen.
  std::int32_t slot_of(std::size_t identity) const {
    return identity < slot_of_.size() ? slot_of_[identity] : kUnseen;
  }
  /// A slot is the same landmark for all particles, so a map is reported as their mixture.
  static constexpr bool kShared = true;
  static constexpr std::int32_t kUnseen = -1;

 private:
  std::vector<std::int32_t> slot_of_;
  std::vector<std::uint32_t> slots_;
  std::vector<RangeBearing<Real>> seen_;
  std::vector<Detection> new_;
  std::vector<typename ParticleMaps<Real>::OpenSlot> opened_;
};

}  // namespace montecarta
