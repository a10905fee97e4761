// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/particle_maps.hpp"
#include "filters/moments/motion_increment.hpp"

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace montecarta {

/// One scan of the past with what was drawn at it.
template <class Real>
struct PastScan {
  MotionIncrement motion;                 ///< since the scan before
  std::vector<std::uint32_t> slots;       ///< of the matches
  std::vector<RangeBearing<Real>> seen;   ///< of the matches
  std::vector<std::size_t> rows;          ///< of the matches, in the scratch of a replay
  std::vector<RangeBearing<Real>> fresh;  ///< of the new landmarks, in order of their slots
  std::vector<BasicPose<Real>> poses;     ///< {block} drawn
  std::vector<Real> log_weights;          ///< {block} of the scan alone
};

/// The last scans of every particle's own past, and its map as it was before them; known
/// association. Keeps its memory from run to run.
template <class Real, class Landmark>
class PoseWindow {
 public:
  PoseWindow(std::size_t particles, std::size_t length)
      : maps_(particles),
        origin_(blocks_for<Real>(particles)),
        spare_poses_(origin_.size()),
        spare_weights_(origin_.size()),
        ring_(length) {
    for (PastScan<Real>& scan : ring_) {
      scan.poses.resize(origin_.size()), scan.log_weights.resize(origin_.size());
    }
  }

  void start(const std::vector<BasicPose<Real>>& poses) {
    maps_.clear();
    std::copy(poses.begin(), poses.end(), origin_.begin());
    first_ = count_ = 0;
  }
  std::size_t size() const { return count_; }
  /// Scan k, the oldest first.
  PastScan<Real>& operator[](std::size_t k) { return ring_[(first_ + k) % ring_.size()]; }
  PastScan<Real>& newest() { return (*this)[count_ - 1]; }

  /// The poses before the first scan of the window, and the maps.
  const std::vector<BasicPose<Real>>& origin() const { return origin_; }
  ParticleMaps<Real, Landmark>& maps() { return maps_; }

  /// Begins a scan. Where the window is full its oldest scan goes into the maps, seen from the
  /// poses that were drawn then: learnt(landmark, pose, seen), born(pose, seen).
  template <class Matches, class Learnt, class Born>
  void add(const MotionIncrement& motion, const Matches& matches, const Learnt& learnt,
           const Born& born) {
    if (count_ == ring_.size()) forget_oldest(learnt, born);
    ++count_;
    PastScan<Real>& scan = newest();
    scan.motion = motion;
    scan.slots.assign(matches.slots().begin(), matches.slots().end());
    scan.seen.assign(matches.seen().begin(), matches.seen().end());
    scan.fresh.clear();
  }

  /// Particle i becomes a copy of particle parents[i].
  void resample(std::span<const std::uint32_t> parents) {
    maps_.resample(parents);
    rearrange(parents, origin_, spare_poses_);
    for (std::size_t k = 0; k < count_; ++k) {
      rearrange(parents, (*this)[k].poses, spare_poses_);
      rearrange(parents, (*this)[k].log_weights, spare_weights_);
    }
  }

 private:
  template <class Column>
  static void rearrange(std::span<const std::uint32_t> parents, Column& column, Column& spare) {
    gather<Real>(column, parents, spare);
    std::swap(column, spare);
  }

  template <class Learnt, class Born>
  void forget_oldest(const Learnt& learnt, const Born& born) {
    const PastScan<Real>& oldest = (*this)[0];
    maps_.open(oldest.slots, opened_);
    for (std::size_t k = 0; k < oldest.slots.size(); ++k) {
      for (std::size_t b = 0; b < origin_.size(); ++b) {
        learnt(opened_[k].fetch(b), oldest.poses[b], oldest.seen[k]);
      }
    }
    for (const RangeBearing<Real>& seen : oldest.fresh) {
      const auto blocks = maps_.blocks_of(maps_.add());
      for (std::size_t b = 0; b < blocks.size(); ++b) blocks[b] = born(oldest.poses[b], seen);
    }
    std::copy(oldest.poses.begin(), oldest.poses.end(), origin_.begin());
    first_ = (first_ + 1) % ring_.size();
    --count_;
  }

  ParticleMaps<Real, Landmark> maps_;
  std::vector<typename ParticleMaps<Real, Landmark>::OpenSlot> opened_;
  std::vector<BasicPose<Real>> origin_, spare_poses_;
  std::vector<Real> spare_weights_;
  std::vector<PastScan<Real>> ring_;
  std::size_t first_ = 0, count_ = 0;
};

}  // namespace montecarta
