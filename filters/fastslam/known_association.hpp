// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/concepts.hpp"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace montecarta::filters {

/// Associates by the identity of each detection, the same for all particles (EQUATIONS 17). Clutter
/// is known to be clutter. Slots are numbered in the order in which landmarks are first observed.
template <class Real, class Held = LandmarkGaussian<Real>>
class KnownAssociation {
 public:
  using Maps = ParticleMaps<Real, Held>;
  explicit KnownAssociation(std::size_t landmarks) : slot_of_(landmarks, kUnseen) {}

  void start() { std::fill(slot_of_.begin(), slot_of_.end(), kUnseen); }
  /// Gives every particle the landmarks of a known map, {identity}.
  void add_known(const StepContext& context, std::span<const LandmarkEstimate> map, Maps& maps) {
    for (std::size_t k = 0; k < map.size(); ++k)
      slot_of_.at(k) = static_cast<std::int32_t>(maps.add(context, map[k]));
  }

  /// Divides the scan into known and new landmarks.
  void associate(const StepContext& context, Scan scan, Maps& maps,
                 const std::vector<PoseGaussian<Real>>& /*predicted*/) {
    slots_.clear(), seen_.clear(), new_.clear();
    for (const Detection& detection : scan) {
      if (detection.identity == Detection::kClutter) continue;
      const std::int32_t slot = slot_of_.at(static_cast<std::size_t>(detection.identity));
      if (slot == kUnseen) {
        new_.push_back(detection);
      } else {
        slots_.push_back(static_cast<std::uint32_t>(slot));
        seen_.push_back(measurement_of<Real>(detection));
      }
    }
    maps.open(context, slots_, opened_);
  }

  bool matched_nothing() const { return slots_.empty() && new_.empty(); }
  std::size_t matches() const { return slots_.size(); }
  /// The weight of the particles that matched detection k, which is that of all particles.
  double matched_weight(std::size_t /*k*/, const Weights<Real>& /*weights*/) const { return 1.0; }

  void fetch(std::size_t b) const {
    for (const auto& slot : opened_) slot.fetch(b);
  }
  [[gnu::always_inline]] Match<Real, Held&, AllLanes> match(std::size_t b, std::size_t k) const {
    return {opened_[k].at(b), seen_[k], {}};
  }
  /// Stores nothing, since match() refers to the map itself.
  template <class Changed>
  void store(std::size_t /*b*/, std::size_t /*k*/, const Changed& /*match*/) const {}
  /// There are no association errors: clutter is ignored, and all other detections are correct.
  AssociationCounts counts(const Weights<Real>& /*weights*/) const {
    return {.correct = static_cast<double>(slots_.size() + new_.size())};
  }
  /// Number of landmarks of a map, which is the same for every particle.
  double map_size(const Maps& maps, const Weights<Real>& /*weights*/) const {
    return static_cast<double>(maps.slots());
  }
  /// All particles explain the same detections, so that no constant is needed.
  Real unmatched_log_weight(std::size_t /*b*/) const { return Real(0.0); }

  /// Gives every new landmark a slot.
  const std::vector<FreshLandmark<Real>>& new_landmarks(const StepContext& context, Maps& maps) {
    fresh_.clear();
    for (const Detection& detection : new_) {
      const std::uint32_t slot = add_slot(context, detection, maps);
      for (std::size_t b = 0; b < maps.blocks(); ++b)
        fresh_.push_back({detection, b, slot, std::nullopt});
    }
    return fresh_;
  }
  void resample(const StepContext& /*context*/, std::span<const std::uint32_t> /*parents*/) {}

  /// The landmark of identity j, as the mixture of all particles, which have it in the same slot.
  std::optional<LandmarkEstimate> landmark(const StepContext& context, std::size_t j,
                                           const Maps& maps, const Weights<Real>& weights) const {
    if (j >= slot_of_.size() || slot_of_[j] == kUnseen) return std::nullopt;
    maps.copy_slot(context, static_cast<std::uint32_t>(slot_of_[j]), source_, copied_);
    return mixture_of_landmarks(context, weights, copied_);
  }

 protected:
  /// Detections of this scan of landmarks that are not in the maps.
  const std::vector<Detection>& new_detections() const { return new_; }
  std::uint32_t add_slot(const StepContext& context, const Detection& detection, Maps& maps) {
    const std::uint32_t slot = maps.add(context);
    slot_of_[static_cast<std::size_t>(detection.identity)] = static_cast<std::int32_t>(slot);
    return slot;
  }

 private:
  static constexpr std::int32_t kUnseen = -1;

  std::vector<std::int32_t> slot_of_;  ///< {identity} slot of the landmark
  std::vector<std::uint32_t> slots_;
  std::vector<Measurement<Real>> seen_;
  std::vector<Detection> new_;
  std::vector<typename Maps::OpenSlot> opened_;
  std::vector<FreshLandmark<Real>> fresh_;
  mutable std::vector<std::uint32_t> source_;           ///< scratch of landmark()
  mutable std::vector<LandmarkGaussian<Real>> copied_;  ///< scratch of landmark()
};

}  // namespace montecarta::filters
