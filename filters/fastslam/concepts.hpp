// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/particle_maps.hpp"
#include "filters/population/population.hpp"

#include <concepts>
#include <optional>
#include <utility>
#include <vector>

// The requirements on the template arguments of FastSLAM, and the types that they exchange.

namespace montecarta::filters {

template <class T, class U>
concept Is = std::same_as<T, U>;

/// Propagates the Gaussian of a pose by motion and observation: `Linearised` and `SigmaPoints`.
template <class T, class Real>
concept CarriesPoses = requires(const T t, MotionIncrement& motion, PoseGaussian<Real>& pose,
                                const LandmarkGaussian<Real>& landmark,
                                const Measurement<Real>& seen, const SensorNoise& R,
                                Evidence<Real>& evidence, const Belief& belief) {
  // Moves by one control step of `duration`.
  t.advance(motion, Control(), /*duration*/ 0.1, belief);
  // Updates the pose with one detection and returns the innovation before the update.
  { t.refine(pose, landmark, seen, R, AllLanes(), evidence) } -> Is<Innovation<Real>>;
  // True if refine_in_batch() can refine a pose by a whole scan with fixed Jacobians.
  { T::kRefinesInBatch } -> std::convertible_to<bool>;
};

/// The form in which `MapTransform` keeps a landmark.
template <class MapTransform, class Real>
using LandmarkStateOf = decltype(std::declval<const MapTransform&>().initialise(
    BasicPose<Real>(), Measurement<Real>(), SensorNoise()));

/// Keeps landmarks, like `Linearised` and `SigmaPoints`: each as a LandmarkGaussian or in a form
/// that gaussian_of() converts to one for poses, weights and association. The form is a struct of
/// Reals, and its default `{}`, a landmark that was never observed, must give a finite Gaussian.
template <class T, class Real>
concept KeepsLandmarks = requires(const T t, const BasicPose<Real>& pose,
                                  LandmarkStateOf<T, Real>& landmark, const Measurement<Real>& seen,
                                  const SensorNoise& R, Evidence<Real>& evidence) {
  // Initialises a landmark from a known pose.
  t.initialise(pose, seen, R);
  // Updates a landmark with one detection from a known pose and returns the innovation before the
  // update.
  { t.update(landmark, pose, seen, R, AllLanes(), evidence) } -> Is<Innovation<Real>>;
  { gaussian_of(landmark) } -> std::convertible_to<LandmarkGaussian<Real>>;
};

/// A detection and the landmarks with which the particles of one block associate it.
template <class Real, class Landmark, class Mask>
struct Match {
  Landmark landmark;  ///< a reference to the map, or a copy if particles matched different ones
  Measurement<Real> seen;
  Mask mask;  ///< mask of the particles that matched the landmark
};

/// A landmark that particles of one block initialise.
template <class Real>
struct FreshLandmark {
  Detection detection;
  std::size_t block;
  std::uint32_t slot;               ///< slot that was added to the maps of the particles
  std::optional<std::size_t> lane;  ///< lane of the particle; nullopt means the whole block

  template <class Block>
  void put(const Block& from, Block& to) const {
    lane ? copy_lane<Real>(from, to, *lane) : void(to = from);
  }
};

/// Decides which landmark of its map a particle associates with a detection.
template <class A, class Real>
concept Associator = requires(A a, const A decided, const StepContext& context, Scan scan,
                              typename A::Maps& maps,
                              const std::vector<PoseGaussian<Real>>& predicted,
                              const Weights<Real>& weights, std::size_t block, std::size_t k) {
  // Begins a run: no landmark is known. Then gives every particle the known ones.
  a.start();
  a.add_known(context, /*map*/ std::span<const LandmarkEstimate>(), maps);
  // Associates a scan for all particles, by their `predicted` poses {block}.
  a.associate(context, scan, maps, predicted);
  { decided.matched_nothing() } -> Is<bool>;
  // The number of detections that may be matched, and the weight of the particles that matched
  // detection k.
  { decided.matches() } -> Is<std::size_t>;
  { decided.matched_weight(k, weights) } -> Is<double>;

  // For each block, fetch() is called first, then match() for each k, and store() if a landmark
  // changed.
  decided.fetch(block);
  decided.store(block, k, decided.match(block, k));
  // Returns log p0 for every detection that a particle has not matched (EQUATIONS 17).
  { decided.unmatched_log_weight(block) } -> Is<Real>;

  // Adds slots to the maps for the caller to fill. If there is initialise(context, maps, poses), it
  // is called instead, and it fills the slots itself.
  { a.new_landmarks(context, maps) } -> std::convertible_to<std::span<const FreshLandmark<Real>>>;
  a.resample(context, /*parents*/ std::span<const std::uint32_t>());
  // The following functions are called for reports.
  { decided.counts(weights) } -> Is<AssociationCounts>;
  { decided.map_size(maps, weights) } -> Is<double>;
  { decided.landmark(context, k, maps, weights) } -> Is<std::optional<LandmarkEstimate>>;
};

/// Moves the particles, and draws and weights their poses, given the decisions of `A`.
template <class P, class Real, class A>
concept PoseProposal = requires(P p, const P now, const StepContext& context, std::size_t block,
                                std::vector<BasicPose<Real>>& poses,
                                const std::vector<PoseGaussian<Real>>& predicted, const A& a,
                                const Weights<Real>& weights, typename A::Maps& maps,
                                const typename MixtureInnovations<Real>::OfBlock& innovations,
                                typename P::Refined& refined, const FreshLandmark<Real>& fresh) {
  // Moves by a control step of `duration`.
  p.predict(context, Control(), /*duration*/ 0.1, poses);
  // Returns the estimates of the particles of their poses before the scan.
  { now.predicted(block, poses[block]) } -> Is<PoseGaussian<Real>>;

  // For each block: refines the pose by the scan, draws a pose from the result, and updates the
  // landmarks from it, which returns the log of the weight's factor. P::Refined links these calls.
  { p.refine(context, block, predicted[block], a, innovations) } -> Is<typename P::Refined>;
  { p.draw(context, block, refined) } -> Is<BasicPose<Real>>;
  { p.update_map(block, poses[block], a, refined, innovations) } -> Is<Weighing<Real>>;

  p.initialise(fresh, poses[block], maps);  // fills the slot of a new landmark
  { now.estimate(context, weights, poses) } -> Is<PoseEstimate>;
};

/// A proposal that keeps a Gaussian for each particle between its steps.
template <class P>
concept KeepsGaussians = requires(P p, const PoseMoments& start) {
  p.start(start);  // begins a run: the Gaussian of each particle is that of the start
  p.end_scan();    // all poses of the scan have been drawn
  p.begin_step();  // the particles of the last scan have been resampled, where that was due
};

/// A proposal that reports columns of its own (FilterKind::reports).
template <class P>
concept HasOwnColumns = requires(P p, const P now) {
  p.begin_report();  // begins a scan, at which it has nothing to report yet
  { now.own_columns() } -> Is<std::span<const double>>;  // in a member, complete after end_scan()
};

/// A proposal that has work to do for all particles together, between association and refinement.
template <class P, class Real, class A>
concept PreparesScan = requires(P p, const StepContext& context, const A& a,
                                const Weights<Real>& weights,
                                const std::vector<PoseGaussian<Real>>& predicted) {
  p.prepare(context, a, weights, predicted);
};

}  // namespace montecarta::filters
