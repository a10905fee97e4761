// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/particle_maps.hpp"
#include "filters/fastslam/two_sightings.hpp"
#include "filters/models/triangulation.hpp"
#include "filters/moments/mounted.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace montecarta::filters {

/// Landmarks that one detection does not fix, until two do (EQUATIONS 15). Detections are kept with
/// the pose of the sensor that each particle has drawn for their scan, and go with its descendants.
/// Steps are decided for all particles together, so that all have the same landmarks. A detection
/// that only decides (whether a pair crosses well, on which side of two places) is dropped: what is
/// chosen by its noise must not be estimated from it.
template <class Real>
class WaitingLandmarks {
 public:
  WaitingLandmarks(std::size_t landmarks, std::size_t particles, const Belief& belief)
      : particles_(particles),
        mounting_(belief.sensor.mounting),
        sightings_(belief.sensor, SensorNoise::of(belief).range),
        waiting_(landmarks),
        sensors_(particles) {}

  void start() {
    std::fill(waiting_.begin(), waiting_.end(), Waiting{});
    sensors_.clear();
  }
  void resample(std::span<const std::uint32_t> parents) { sensors_.resample(parents); }

  /// One more detection, from vehicles at `poses` {block}. Returns whether its landmark is fixed
  /// now.
  bool advance(const Detection& detection, const std::vector<BasicPose<Real>>& poses) {
    Waiting& waiting = waiting_[static_cast<std::size_t>(detection.identity)];
    open(waiting);
    switch (waiting.stage) {
      case Stage::unseen:
        keep(waiting, detection, poses);
        waiting.stage = Stage::seen;
        return false;
      case Stage::seen:
        if (all_of([&](std::size_t i) {
              return sightings_.cross_well(kept(waiting, 0, i), now(detection, poses, i));
            }))
          waiting.stage = Stage::crossing;
        return false;
      case Stage::crossing:
        if (!all_of([&](std::size_t i) {
              return sightings_.crossing(kept(waiting, 0, i), now(detection, poses, i), 1.0);
            }))
          return false;
        keep(waiting, detection, poses);
        waiting.stage = Stage::ambiguous;
        return sightings_.of_bearings();
      case Stage::ambiguous: {
        const auto side = chosen_side(least_squared_distance(waiting, detection, poses, 1.0),
                                      least_squared_distance(waiting, detection, poses, -1.0));
        waiting.side = side.value_or(1.0);
        return side.has_value();
      }
    }
    return false;
  }

  /// Where every particle has the landmark that advance() has found fixed.
  void place(std::int32_t identity, std::span<LandmarkGaussian<Real>> blocks) {
    const Waiting& waiting = waiting_[static_cast<std::size_t>(identity)];
    open(waiting);
    for (std::size_t i = 0; i < particles_; ++i) {
      const auto at = sightings_.crossing(kept(waiting, 0, i), kept(waiting, 1, i), waiting.side);
      const Eigen::Matrix2d& P = at->covariance;
      LandmarkGaussian<Real>& block = blocks[i / kLanes];
      const std::size_t lane = i % kLanes;
      set(block.mean.x, lane, at->point.x()), set(block.mean.y, lane, at->point.y());
      set(block.covariance.xx, lane, P(0, 0)), set(block.covariance.yy, lane, P(1, 1));
      set(block.covariance.xy, lane, P(0, 1));
    }
  }

 private:
  static constexpr std::size_t kLanes = kLanesOf<Real>;

  /// What is known of a landmark.
  enum class Stage : std::uint8_t {
    unseen,
    seen,       ///< by a first detection
    crossing,   ///< and a second one would cross it well: the next is used
    ambiguous,  ///< two are kept; of ranges that leaves two places
  };
  struct Waiting {
    Stage stage = Stage::unseen;
    std::size_t kept = 0;                  ///< detections
    std::array<std::uint32_t, 2> slots{};  ///< of the poses that they were made from
    std::array<double, 2> values{};        ///< [m] or [rad]
    double side = 1.0;                     ///< of two places
  };

  void keep(Waiting& waiting, const Detection& detection,
            const std::vector<BasicPose<Real>>& poses) {
    const std::uint32_t slot = sensors_.add();
    const auto blocks = sensors_.blocks_of(slot);
    for (std::size_t b = 0; b < blocks.size(); ++b) blocks[b] = mounting_.sensor(poses[b]);
    waiting.slots[waiting.kept] = slot;
    waiting.values[waiting.kept++] = detection[0];
  }
  void open(const Waiting& waiting) {
    sensors_.open(std::span(waiting.slots).first(waiting.kept), opened_);
    for (const auto& slot : opened_) {
      for (std::size_t b = 0; b < sensors_.blocks(); ++b) slot.fetch(b);
    }
  }

  static Pose pose_of(const BasicPose<Real>& block, std::size_t lane) {
    return {get(block.x, lane), get(block.y, lane), get(block.heading, lane)};
  }
  Sighting kept(const Waiting& waiting, std::size_t k, std::size_t particle) const {
    return {pose_of(opened_[k].at(particle / kLanes), particle % kLanes), waiting.values[k]};
  }
  Sighting now(const Detection& detection, const std::vector<BasicPose<Real>>& poses,
               std::size_t particle) const {
    return {mounting_.sensor(pose_of(poses[particle / kLanes], particle % kLanes)), detection[0]};
  }

  template <class Holds>
  bool all_of(const Holds& holds) const {
    for (std::size_t i = 0; i < particles_; ++i) {
      if (!holds(i)) return false;
    }
    return true;
  }
  /// D^2 of the particle that it fits best.
  double least_squared_distance(const Waiting& waiting, const Detection& detection,
                                const std::vector<BasicPose<Real>>& poses, double side) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < particles_; ++i) {
      least = std::min(least, sightings_.squared_distance(kept(waiting, 0, i), kept(waiting, 1, i),
                                                          side, now(detection, poses, i)));
    }
    return least;
  }

  std::size_t particles_;
  MountedPose mounting_;
  TwoSightings sightings_;
  std::vector<Waiting> waiting_;                 ///< {identity}
  ParticleMaps<Real, BasicPose<Real>> sensors_;  ///< poses of the sensor
  std::vector<typename ParticleMaps<Real, BasicPose<Real>>::OpenSlot> opened_;
};

}  // namespace montecarta::filters
