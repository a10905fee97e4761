// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/particle_maps.hpp"
#include "filters/moments/correlated_observation.hpp"

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace montecarta::filters {

/// The joint Gaussian of poses and those slots of the particles' maps that were seen since poses
/// were drawn. What it believes of each landmark alone is written back to the maps at every scan,
/// so that those are whole for whoever looks.
template <class Real>
class DelayedMap {
 public:
  using Landmark = LandmarkGaussian<Real>;
  using Maps = ParticleMaps<Real>;
  explicit DelayedMap(std::size_t blocks) : map_(blocks) {}

  CorrelatedMap<Real>& map() { return map_; }
  const CorrelatedMap<Real>& map() const { return map_; }

  void clear() {
    for (const std::uint32_t slot : slots_) index_of_[slot] = kOut;
    slots_.clear();
    map_.clear();
  }
  bool holds(std::uint32_t slot) const {
    return slot < index_of_.size() && index_of_[slot] != kOut;
  }
  /// Of the innovation of a landmark, of a slot that it holds, seen from the pose of block b.
  Symmetric2<Real> covariance(std::uint32_t slot, std::size_t b, const PoseGaussian<Real>& pose,
                              const Landmark& landmark, const LineOfSight<Real>& s,
                              const SensorNoise& noise) const {
    return correlated_innovation(pose.covariance, landmark.covariance,
                                 map_.pose_cross(index_of_[slot], b), ObservationRows<Real>(s), {},
                                 noise)
        .S;
  }

  /// Takes in the slots of all matches; every block of each must then be fill()ed and written back.
  void enter(std::span<const std::uint32_t> matched_slots, Maps& maps) {
    first_entered_ = slots_.size();
    for (const std::uint32_t slot : matched_slots) {
      if (!holds(slot)) enter(slot);
    }
    written_.resize(slots_.size());
    for (std::size_t i = 0; i < slots_.size(); ++i) written_[i] = maps.rewrite(slots_[i]);
  }
  /// Copies what block b, once fetched, holds of the slots that came in by this scan.
  void fill(std::size_t b) {
    for (std::size_t i = first_entered_; i < slots_.size(); ++i)
      map_.landmark(i, b) = written_[i][b];
  }
  /// Writes believed(landmark, cross-covariance with the pose) of every landmark to block b of its
  /// slot.
  template <class Believed>
  void write_back(std::size_t b, const Believed& believed) {
    for (std::size_t i = 0; i < slots_.size(); ++i) {
      written_[i][b] = believed(map_.landmark(i, b), map_.pose_cross(i, b));
    }
  }
  /// The number of a slot that has just been added to, taken in where it is not yet.
  std::size_t index_of_added(std::uint32_t slot, Maps& maps) {
    if (holds(slot)) return index_of_[slot];
    const std::size_t i = enter(slot);
    const std::span<const Landmark> blocks = maps.blocks_of(slot);
    for (std::size_t b = 0; b < blocks.size(); ++b) map_.landmark(i, b) = blocks[b];
    return i;
  }

  /// Which landmark match k of a scan is in block b.
  template <class Associating>
  auto where(const Associating& association, std::size_t b, std::size_t k) const {
    return association.where(b, k, std::span<const std::size_t>(index_of_));
  }
  /// Pose and matched landmarks alone, detection by detection, into block b of `to`.
  template <class Associating>
  void copy_matches(const Associating& association, std::size_t b, CorrelatedMap<Real>& to) const {
    to.pose(b) = map_.pose(b);
    for (std::size_t k = 0; map_.size() > 0 && k < to.size(); ++k) {
      const auto at = where(association, b, k);
      to.landmark(k, b) = map_.landmark(at, b);
      to.pose_cross(k, b) = map_.pose_cross(at, b);
      for (std::size_t l = 0; l < k; ++l) {
        to.map_cross(k, l, b) = map_.covariance(at, where(association, b, l), b);
      }
    }
  }

 private:
  static constexpr std::size_t kOut = std::numeric_limits<std::size_t>::max();

  std::size_t enter(std::uint32_t slot) {
    if (slot >= index_of_.size()) index_of_.resize(slot + 1, kOut);
    slots_.push_back(slot);
    return index_of_[slot] = map_.add();
  }

  CorrelatedMap<Real> map_;
  std::vector<std::size_t> index_of_;         ///< {slot} its landmark, or kOut
  std::vector<std::uint32_t> slots_;          ///< {landmark} its slot
  std::size_t first_entered_ = 0;             ///< of the scan's new landmarks
  std::vector<std::span<Landmark>> written_;  ///< {landmark} its slot's blocks
};

}  // namespace montecarta::filters
