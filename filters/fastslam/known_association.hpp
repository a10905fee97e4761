// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/concepts.hpp"
#include "filters/population/cloud_moments.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace montecarta::filters {

/// Detections carry the identity of their landmark, the same for all particles (EQUATIONS 17);
/// clutter is known to be clutter. Slots are given out in the order in which landmarks are first
/// seen.
template <class Real, class Held = LandmarkGaussian<Real>>
class KnownAssociation {
 public:
  using Maps = ParticleMaps<Real, Held>;
  explicit KnownAssociation(std::size_t landmarks) : slot_of_(landmarks, kUnseen) {}

  void start() { std::fill(slot_of_.begin(), slot_of_.end(), kUnseen); }

  /// Sorts the scan into known and new landmarks.
  void associate(const StepContext& /*context*/, Scan scan, Maps& maps,
                 const std::vector<PoseGaussian<Real>>& /*predicted*/) {
    slots_.clear(), seen_.clear(), new_.clear();
    for (const Detection& detection : scan) {
      if (detection.identity == Detection::kClutter) continue;
      const std::int32_t slot = slot_of_.at(static_cast<std::size_t>(detection.identity));
      if (slot == kUnseen) {
        new_.push_back(detection);
      } else {
        slots_.push_back(static_cast<std::uint32_t>(slot));
        seen_.push_back(observation_of<Real>(detection));
      }
    }
    maps.open(slots_, opened_);
  }

  bool matched_nothing() const { return slots_.empty() && new_.empty(); }
  std::size_t matches() const { return slots_.size(); }
  /// The weight of the particles that matched detection k: all.
  double matched_weight(std::size_t /*k*/, const Weights<Real>& /*weights*/) const { return 1.0; }

  void fetch(std::size_t b) const {
    for (const auto& slot : opened_) slot.fetch(b);
  }
  [[gnu::always_inline]] Match<Real, Held&, Everywhere> match(std::size_t b, std::size_t k) const {
    return {opened_[k].at(b), seen_[k], {}};
  }
  /// match() refers to the map itself.
  template <class Changed>
  void store(std::size_t /*b*/, std::size_t /*k*/, const Changed& /*match*/) const {}
  /// Nobody errs: clutter is left out, all else goes where it belongs.
  AssociationCounts counts(const Weights<Real>& /*weights*/) const {
    return {.correct = static_cast<double>(slots_.size() + new_.size())};
  }
  /// Landmarks of a map; every particle has as many.
  double map_size(const Maps& maps, const Weights<Real>& /*weights*/) const {
    return static_cast<double>(maps.slots());
  }
  /// All particles explain the same detections, so there is nothing to make equal.
  Real unmatched_log_weight(std::size_t /*b*/) const { return Real(0.0); }

  /// Gives every new landmark a slot.
  const std::vector<FreshLandmark<Real>>& new_landmarks(Maps& maps) {
    fresh_.clear();
    for (const Detection& detection : new_) {
      const std::uint32_t slot = add_slot(detection, maps);
      for (std::size_t b = 0; b < maps.blocks(); ++b)
        fresh_.push_back({detection, b, slot, std::nullopt});
    }
    return fresh_;
  }
  void resample(std::span<const std::uint32_t> /*parents*/) {}

  /// Of identity j: the mixture of all particles, for which a slot is the same landmark.
  std::optional<LandmarkEstimate> landmark(std::size_t j, const Maps& maps,
                                           const Weights<Real>& weights) const {
    if (j >= slot_of_.size() || slot_of_[j] == kUnseen) return std::nullopt;
    maps.copy_slot(static_cast<std::uint32_t>(slot_of_[j]), source_, copied_);
    return mixture_of_landmarks(weights, copied_);
  }

 protected:
  /// Detections of the scan whose landmarks are not in the maps.
  const std::vector<Detection>& new_detections() const { return new_; }
  std::uint32_t add_slot(const Detection& detection, Maps& maps) {
    const std::uint32_t slot = maps.add();
    slot_of_[static_cast<std::size_t>(detection.identity)] = static_cast<std::int32_t>(slot);
    return slot;
  }

 private:
  static constexpr std::int32_t kUnseen = -1;

  std::vector<std::int32_t> slot_of_;  ///< {identity}
  std::vector<std::uint32_t> slots_;
  std::vector<RangeBearing<Real>> seen_;
  std::vector<Detection> new_;
  std::vector<typename Maps::OpenSlot> opened_;
  std::vector<FreshLandmark<Real>> fresh_;
  mutable std::vector<std::uint32_t> source_;           ///< scratch of landmark()
  mutable std::vector<LandmarkGaussian<Real>> copied_;  ///< likewise
};

}  // namespace montecarta::filters
