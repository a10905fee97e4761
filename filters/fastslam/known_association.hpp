// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/association/waiting_landmarks.hpp"
#include "filters/fastslam/concepts.hpp"
#include "filters/fastslam/particle_maps.hpp"
#include "filters/fastslam/sensor_policy.hpp"
#include "filters/population/population.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
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
        seen_.push_back(observation_of<Real>(detection));
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
  /// Nothing is to be stored, since match() refers to the map itself.
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

  std::vector<std::int32_t> slot_of_;  ///< {identity}
  std::vector<std::uint32_t> slots_;
  std::vector<RangeBearing<Real>> seen_;
  std::vector<Detection> new_;
  std::vector<typename Maps::OpenSlot> opened_;
  std::vector<FreshLandmark<Real>> fresh_;
  mutable std::vector<std::uint32_t> source_;           ///< scratch of landmark()
  mutable std::vector<LandmarkGaussian<Real>> copied_;  ///< scratch of landmark()
};

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
        sightings_(belief.sensor, SensorNoise::of(belief).range),
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
    std::array<double, 2> values{};        ///< [m] or [rad]
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

  static Pose pose_of(const BasicPose<Real>& block, std::size_t lane) {
    return {get(block.x, lane), get(block.y, lane), get(block.heading, lane)};
  }
  Sighting kept(const Kept& kept, std::size_t k, std::size_t particle) const {
    return {pose_of(opened_[k].at(particle / kLanes), particle % kLanes), kept.values[k]};
  }
  Sighting now(const Detection& detection, const std::vector<BasicPose<Real>>& poses,
               std::size_t particle) const {
    return {mounting_.sensor(pose_of(poses[particle / kLanes], particle % kLanes)), detection[0]};
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
