// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/delayed_map.hpp"
#include "filters/fastslam/particle_maps.hpp"
#include "filters/moments/linearised.hpp"
#include "filters/moments/motion_increment.hpp"
#include "filters/population/population.hpp"

#include <concepts>
#include <optional>
#include <vector>

// What the arguments of the FastSLAM templates must offer, and what passes between them.

namespace montecarta {

/// Carries the Gaussians of poses and landmarks through motion and sight: `Linearised` and
/// `SigmaPoints` of moments/moment_transforms.hpp.
template <class T, class Real>
concept MomentTransform = requires(const T transform, MotionIncrement& motion,
                                   PoseGaussian<Real>& pose, LandmarkGaussian<Real>& landmark,
                                   const RangeBearing<Real>& seen, const SensorNoise& noise,
                                   Evidence<Real>& evidence, const Belief& belief) {
  // one control step of `duration`
  transform.advance(motion, Control(), /*duration*/ 0.1, belief);
  // the pose absorbs one detection; returns its innovation against the pose before
  {
    transform.refine(pose, landmark, seen, noise, Everywhere(), evidence)
    } -> std::same_as<Innovation<Real>>;
  // the landmark absorbs one detection made from a known pose; likewise
  {
    transform.update(landmark, pose.mean, seen, noise, Everywhere(), evidence)
    } -> std::same_as<Innovation<Real>>;
  // a landmark seen for the first time from a known pose
  { transform.initialise(pose.mean, seen, noise) } -> std::same_as<LandmarkGaussian<Real>>;
};

/// A detection, and the landmark that the particles of one block take it for.
template <class Real, class Landmark, class Mask>
struct Match {
  Landmark landmark;  ///< the map's own, or a copy where each particle has
                      ///< another one
  RangeBearing<Real> seen;
  Mask mask;  ///< the particles that matched it
};

/// A landmark that particles of one block see for the first time.
template <class Real>
struct FreshLandmark {
  Detection detection;
  std::size_t block;
  std::uint32_t slot;               ///< that was added to their maps
  std::optional<std::size_t> lane;  ///< of the particle; nothing: all of the block

  template <class Block>
  void put(const Block& from, Block& to) const {
    lane ? copy_lane<Real>(from, to, *lane) : void(to = from);
  }
};

/// Decides which landmark of its map a particle takes a detection for.
template <class A, class Real>
concept Associator = requires(A association, const A decided, const StepContext& context, Scan scan,
                              ParticleMaps<Real>& maps,
                              const std::vector<PoseGaussian<Real>>& predicted,
                              const DelayedMap<Real>* joint, const Weights<Real>& weights,
                              std::span<const std::uint32_t> parents, std::size_t index) {
  association.start();  // of a run: no landmark is known
  // decides for all particles, `predicted` {block} their poses; `joint` as a PoseProposal has it
  association.associate(context, scan, maps, predicted, joint);
  { decided.found_nothing() } -> std::same_as<bool>;
  // detections that some particle may have matched, and the weight of those that did
  { decided.matches() } -> std::same_as<std::size_t>;
  { decided.matched_weight(/*match*/ index, weights) } -> std::same_as<double>;
  // the landmarks of all matches, each perhaps many times
  { decided.matched_slots() } -> std::convertible_to<std::span<const std::uint32_t>>;

  // block by block: first fetch(), then match(), and store() where its landmark has changed
  decided.fetch(/*block*/ index);
  decided.store(/*block*/ index, /*match*/ index, decided.match(index, index));
  // which landmark of a CorrelatedMap a match is: ForAll or ForEach, index_of {slot}
  decided.where(/*block*/ index, /*match*/ index, std::span<const std::size_t>());
  // log p0 for every detection that a particle has not matched (SPEC 17)
  { decided.unmatched_log_weight(/*block*/ index) } -> std::same_as<Real>;

  // adds slots to the maps, for the caller to fill
  { association.new_landmarks(maps) } -> std::convertible_to<std::span<const FreshLandmark<Real>>>;
  association.resample(parents);
  // for reports
  { decided.counts(weights) } -> std::same_as<AssociationCounts>;
  { decided.map_size(maps, weights) } -> std::same_as<double>;
  { decided.landmark(index, maps, weights) } -> std::same_as<std::optional<LandmarkEstimate>>;
};

/// Moves the particles, and draws and weighs their poses, given what `A` decided.
template <class P, class Real, class A>
concept PoseProposal = requires(P proposal, const P now, const StepContext& context,
                                std::size_t block, std::vector<BasicPose<Real>>& poses,
                                const std::vector<PoseGaussian<Real>>& predicted,
                                const A& association, const Weights<Real>& weights,
                                ParticleMaps<Real>& maps,
                                const typename MixtureInnovations<Real>::OfBlock& innovations,
                                typename P::Refined& refined, const FreshLandmark<Real>& fresh,
                                std::span<const std::uint32_t> parents) {
  proposal.start();  // of a run
  proposal.predict(context, Control(), /*duration*/ 0.1, poses);
  // what a particle believes of its pose before the scan is looked at
  { now.predicted(block, poses[block]) } -> std::same_as<PoseGaussian<Real>>;

  // a scan: once for all particles, before and after it is associated
  proposal.begin_scan(context, poses);
  {
    now.joint()
    } -> std::same_as<const DelayedMap<Real>*>;  // of pose and map, if any is
                                                 // kept
  proposal.prepare(context, association, weights, poses, predicted, maps);

  // block by block: the pose refined by the scan, drawn from that, and the map seen from there;
  // what one leaves for the next is in P::Refined
  {
    proposal.refine(context, block, predicted[block], association, innovations)
    } -> std::same_as<typename P::Refined>;
  { proposal.draw(context, block, refined) } -> std::same_as<BasicPose<Real>>;
  {
    proposal.update_map(block, poses[block], association, refined, innovations)
    } -> std::same_as<Weighing<Real>>;

  proposal.end_scan();
  proposal.initialise(fresh, poses[block],
                      maps);  // fills the slot of a new landmark
  // before the next step: `parents` of the particles, empty where they were not resampled
  proposal.begin_step(parents);
  { now.estimate(weights, poses) } -> std::same_as<PoseEstimate>;
};

}  // namespace montecarta
