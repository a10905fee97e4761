// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/association/waiting_landmarks.hpp"
#include "filters/fastslam/known_association.hpp"
#include "filters/fastslam/sensor_policy.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace montecarta::filters {

/// Initialises landmarks from two detections for every particle, given its path (EQUATIONS 15). A
/// detection is kept with the pose of the sensor that each particle drew at its scan, and is
/// inherited by the descendants of the particle. All particles advance together, so that they have
/// the same landmarks.
template <class Real>
class InitialisationOnPaths {
 public:
  InitialisationOnPaths(std::size_t particles, const Belief& belief)
      : particles_(particles),
        mounting_(belief.sensor.mounting),
        sightings_(belief.sensor, SensorNoise::of(belief).first),
        waiting_(belief.sensor),
        sensors_(particles) {}

  void start() {
    waiting_.clear();
    sensors_.clear();
  }
  void resample(const StepContext& context, std::span<const std::uint32_t> parents) {
    sensors_.resample(context, parents);
  }

  /// Adds one detection from vehicles at `poses` {block}. Returns whether its landmark is fixed
  /// now.
  bool advance(const StepContext& context, const Detection& detection,
               const std::vector<BasicPose<Real>>& poses) {
    Waiting& waiting = waiting_.entry(detection.identity);
    open(context, waiting.kept);
    if (!waiting_.can_advance(waiting, Pairs{*this, waiting.kept, detection, poses})) return false;
    return waiting_.advance(waiting, [&] { keep(context, waiting.kept, detection, poses); });
  }

  /// Writes the landmark that advance() has fixed, for every particle; it waits no longer.
  void place(const StepContext& context, std::int32_t identity,
             std::span<LandmarkGaussian<Real>> blocks) {
    Waiting& waiting = waiting_.entry(identity);
    open(context, waiting.kept);
    for (std::size_t i = 0; i < particles_; ++i) {
      const auto at =
          sightings_.crossing(kept(waiting.kept, 0, i), kept(waiting.kept, 1, i), waiting.side);
      const Eigen::Matrix2d& P = at->covariance;
      LandmarkGaussian<Real>& block = blocks[i / kLanes];
      const std::size_t lane = i % kLanes;
      set(block.mean.x, lane, at->point.x()), set(block.mean.y, lane, at->point.y());
      set(block.covariance.xx, lane, P(0, 0)), set(block.covariance.yy, lane, P(1, 1));
      set(block.covariance.xy, lane, P(0, 1));
    }
    waiting_.remove(waiting);
  }

 private:
  static constexpr std::size_t kLanes = kLanesOf<Real>;

  struct Kept {
    std::size_t count = 0;                 ///< number of detections
    std::array<std::uint32_t, 2> slots{};  ///< slots of the poses of the sensor
    std::array<double, 2> values{};        ///< [m] or [rad] values of the kept detections
  };
  using Waiting = typename WaitingLandmarks<Kept>::Waiting;

  /// A new detection together with the kept ones, for all particles.
  struct Pairs {
    const InitialisationOnPaths& on;
    const Kept& kept;
    const Detection& detection;
    const std::vector<BasicPose<Real>>& poses;

    template <class Holds>
    bool all_of(const Holds& holds) const {
      for (std::size_t i = 0; i < on.particles_; ++i) {
        if (!holds(on.kept(kept, 0, i), on.now(detection, poses, i))) return false;
      }
      return true;
    }
    bool cross_well() const {
      return all_of([&](const Sighting& first, const Sighting& second) {
        return on.sightings_.cross_well(first, second);
      });
    }
    bool cross() const {
      return all_of([&](const Sighting& first, const Sighting& second) {
        return on.sightings_.crossing(first, second, 1.0).has_value();
      });
    }
    /// D^2 of the particle for which it is least.
    double squared_distance(double side) const {
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < on.particles_; ++i) {
        least =
            std::min(least, on.sightings_.squared_distance(on.kept(kept, 0, i), on.kept(kept, 1, i),
                                                           side, on.now(detection, poses, i)));
      }
      return least;
    }
  };

  void keep(const StepContext& context, Kept& kept, const Detection& detection,
            const std::vector<BasicPose<Real>>& poses) {
    const std::uint32_t slot = sensors_.add(context);
    const auto blocks = sensors_.blocks_of(slot);
    for (std::size_t b = 0; b < blocks.size(); ++b) blocks[b] = mounting_.sensor(poses[b]);
    kept.slots[kept.count] = slot;
    kept.values[kept.count++] = detection[0];
  }
  void open(const StepContext& context, const Kept& kept) {
    sensors_.open(context, std::span(kept.slots).first(kept.count), opened_);
    for (const auto& slot : opened_) {
      for (std::size_t b = 0; b < sensors_.blocks(); ++b) slot.fetch(b);
    }
  }

  Sighting kept(const Kept& kept, std::size_t k, std::size_t particle) const {
    return {of_lane(opened_[k].at(particle / kLanes), particle % kLanes), kept.values[k]};
  }
  Sighting now(const Detection& detection, const std::vector<BasicPose<Real>>& poses,
               std::size_t particle) const {
    return {mounting_.sensor(of_lane(poses[particle / kLanes], particle % kLanes)), detection[0]};
  }

  std::size_t particles_;
  MountedPose mounting_;
  TwoSightings sightings_;
  WaitingLandmarks<Kept> waiting_;
  ParticleMaps<Real, BasicPose<Real>> sensors_;  ///< poses of the sensor at kept detections
  std::vector<typename ParticleMaps<Real, BasicPose<Real>>::OpenSlot> opened_;
};

/// KnownAssociation for a sensor with detections that do not fix a landmark. It initialises
/// landmarks itself, from several detections. Detections of waiting landmarks change no weights.
template <class Real>
class DelayedKnownAssociation : public KnownAssociation<Real> {
 public:
  DelayedKnownAssociation(std::size_t landmarks, std::size_t particles, const Belief& belief)
      : KnownAssociation<Real>(landmarks), waiting_(particles, belief) {}

  void start() {
    KnownAssociation<Real>::start();
    waiting_.start();
  }
  /// Initialises landmarks from vehicles at `poses` {block}, drawn for this scan.
  void initialise(const StepContext& context, ParticleMaps<Real>& maps,
                  const std::vector<BasicPose<Real>>& poses) {
    for (const Detection& detection : this->new_detections()) {
      if (!waiting_.advance(context, detection, poses)) continue;
      waiting_.place(context, detection.identity,
                     maps.blocks_of(this->add_slot(context, detection, maps)));
    }
  }
  void resample(const StepContext& context, std::span<const std::uint32_t> parents) {
    waiting_.resample(context, parents);
  }

 private:
  InitialisationOnPaths<Real> waiting_;
};

}  // namespace montecarta::filters
