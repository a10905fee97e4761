// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/particle_maps.hpp"
#include "filters/moments/linearised.hpp"
#include "filters/moments/motion_increment.hpp"
#include "filters/population/population.hpp"

#include <concepts>
#include <optional>
#include <utility>
#include <vector>

// What the arguments of the FastSLAM templates must offer, and what passes between them.

namespace montecarta::filters {

template <class T, class U>
concept Is = std::same_as<T, U>;

/// Carries the Gaussian of a pose through motion and observation: `Linearised` and `SigmaPoints`.
template <class T, class Real>
concept CarriesPoses = requires(const T t, MotionIncrement& motion, PoseGaussian<Real>& pose,
                                const LandmarkGaussian<Real>& landmark,
                                const RangeBearing<Real>& seen, const SensorNoise& R,
                                Evidence<Real>& evidence, const Belief& belief) {
  // one control step of `duration`
  t.advance(motion, Control(), /*duration*/ 0.1, belief);
  // updates the pose with one detection: its innovation before
  { t.refine(pose, landmark, seen, R, Everywhere(), evidence) } -> Is<Innovation<Real>>;
  // whether it can refine a pose by a whole scan with fixed Jacobians, refine_in_batch()
  { T::kRefinesInBatch } -> std::convertible_to<bool>;
};

/// What `MapTransform` keeps of a landmark.
template <class MapTransform, class Real>
using HeldBy = decltype(std::declval<const MapTransform&>().initialise(
    BasicPose<Real>(), RangeBearing<Real>(), SensorNoise()));

/// Keeps landmarks, as those two do: each as a LandmarkGaussian, or in a form of its own that
/// gaussian_of() gives as one, which is all that poses, weights and association see of it. A form
/// is a struct of Reals; one that was never seen, `{}`, must give a finite Gaussian.
template <class T, class Real>
concept KeepsLandmarks = requires(const T t, const BasicPose<Real>& pose, HeldBy<T, Real>& landmark,
                                  const RangeBearing<Real>& seen, const SensorNoise& R,
                                  Evidence<Real>& evidence) {
  // a landmark seen for the first time from a known pose
  t.initialise(pose, seen, R);
  // updates it with one detection from a known pose: its innovation before
  { t.update(landmark, pose, seen, R, Everywhere(), evidence) } -> Is<Innovation<Real>>;
  { gaussian_of(landmark) } -> std::convertible_to<LandmarkGaussian<Real>>;
};

/// A detection, and the landmark that the particles of one block take it for.
template <class Real, class Landmark, class Mask>
struct Match {
  Landmark landmark;  ///< the map's own, or a copy where each particle has another one
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
concept Associator = requires(A a, const A decided, const StepContext& context, Scan scan,
                              typename A::Maps& maps,
                              const std::vector<PoseGaussian<Real>>& predicted,
                              const Weights<Real>& weights, std::size_t block, std::size_t k) {
  // a run: no landmark is known
  a.start();
  // a scan: decides for all particles, by their `predicted` poses {block}
  a.associate(context, scan, maps, predicted);
  { decided.matched_nothing() } -> Is<bool>;
  // detections that some particle may have matched, and the weight of those that did
  { decided.matches() } -> Is<std::size_t>;
  { decided.matched_weight(k, weights) } -> Is<double>;

  // a block: first fetch(), then a Match for each k, and store() where its landmark changed
  decided.fetch(block);
  decided.store(block, k, decided.match(block, k));
  // log p0 for every detection that a particle has not matched (EQUATIONS 17)
  { decided.unmatched_log_weight(block) } -> Is<Real>;

  // adds slots to the maps, for the caller to fill; one that has initialise(maps, poses) is asked
  // that instead, and fills them itself
  { a.new_landmarks(maps) } -> std::convertible_to<std::span<const FreshLandmark<Real>>>;
  a.resample(/*parents*/ std::span<const std::uint32_t>());
  // for reports
  { decided.counts(weights) } -> Is<AssociationCounts>;
  { decided.map_size(maps, weights) } -> Is<double>;
  { decided.landmark(k, maps, weights) } -> Is<std::optional<LandmarkEstimate>>;
};

/// Moves the particles, and draws and weighs their poses, given what `A` decided.
template <class P, class Real, class A>
concept PoseProposal = requires(P p, const P now, const StepContext& context, std::size_t block,
                                std::vector<BasicPose<Real>>& poses,
                                const std::vector<PoseGaussian<Real>>& predicted, const A& a,
                                const Weights<Real>& weights, typename A::Maps& maps,
                                const typename MixtureInnovations<Real>::OfBlock& innovations,
                                typename P::Refined& refined, const FreshLandmark<Real>& fresh) {
  // a run, and a control step of `duration`
  p.start();
  p.predict(context, Control(), /*duration*/ 0.1, poses);
  // what a particle believes of its pose before the scan is looked at
  { now.predicted(block, poses[block]) } -> Is<PoseGaussian<Real>>;

  // a scan that was associated, once for all particles
  p.prepare(context, a, weights, predicted);

  // a block: the pose refined by the scan, the pose drawn from that, and the landmarks updated
  // from there with the log of the weight's factor; P::Refined is what one leaves for the next
  { p.refine(context, block, predicted[block], a, innovations) } -> Is<typename P::Refined>;
  { p.draw(context, block, refined) } -> Is<BasicPose<Real>>;
  { p.update_map(block, poses[block], a, refined, innovations) } -> Is<Weighing<Real>>;

  p.end_scan();
  p.initialise(fresh, poses[block], maps);  // fills the slot of a new landmark
  p.begin_step();                           // after resampling
  { now.estimate(weights, poses) } -> Is<PoseEstimate>;
};

}  // namespace montecarta::filters
