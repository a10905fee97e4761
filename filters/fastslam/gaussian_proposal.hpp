// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/concepts.hpp"

#include <optional>
#include <vector>

namespace montecarta::filters {

/// The time at which the weights of a scan are computed: from the Gaussian of a particle before the
/// draw, or from the drawn pose. In the second case they do not belong to the Gaussians before the
/// draw, and the mixture of these is not an estimate (EQUATIONS 19).
enum class WeightTime { before_draw, after_draw };

/// The part that is common to filters that draw poses from Gaussians refined by the scan (EQUATIONS
/// 4): prediction, refinement, maps, and the estimate between scans. `PoseTransform` propagates the
/// Gaussians of the poses, `MapTransform` those of the landmarks.
template <class Real, CarriesPoses<Real> PoseTransform, KeepsLandmarks<Real> MapTransform>
class RefinedCloud {
 public:
  using Landmark = LandmarkStateOf<MapTransform, Real>;
  RefinedCloud(std::size_t particles, const Belief& belief, WeightTime weighed,
               const PoseTransform& pose_transform, const MapTransform& map_transform)
      : belief_(belief),
        noise_(SensorNoise::of(belief)),
        pose_transform_(pose_transform),
        map_transform_(map_transform),
        weighed_(weighed),
        posterior_(blocks_for<Real>(particles)) {}

  void start(const PoseMoments& start) {
    motion_.restart();
    if (!start.covariance.isZero(0.0)) {  // in the frame of the pose, as a motion
      const Direction<double> d = direction_of(start.mean.heading);
      motion_ = {Pose(), turned(symmetric_of(start.covariance), {d.cosine, -d.sine})};
    }
    begin_step();
  }
  void predict(const StepContext& /*context*/, const Control& control, double duration,
               std::vector<BasicPose<Real>>& /*poses*/) {
    pose_transform_.advance(motion_, control, duration, belief_);
  }
  PoseGaussian<Real> predicted(std::size_t /*b*/, const BasicPose<Real>& drawn) const {
    return motion_.from(drawn);
  }

  /// Records that all poses have been drawn, so that no uncertainty is left within a particle.
  void end_scan() {
    motion_.restart();
    is_drawn_ = true;
  }
  void initialise(const FreshLandmark<Real>& fresh, const BasicPose<Real>& pose,
                  ParticleMaps<Real, Landmark>& maps) const {
    fresh.put(map_transform_.initialise(pose, measurement_of<Real>(fresh.detection), noise_),
              maps.blocks_of(fresh.slot)[fresh.block]);
  }
  void begin_step() {
    moments_.reset();
    is_drawn_ = false;
  }
  PoseEstimate estimate(const StepContext& context, const Weights<Real>& weights,
                        const std::vector<BasicPose<Real>>& poses) const {
    const bool has_mixture = weighed_ == WeightTime::before_draw;
    if (is_drawn_) {
      PoseEstimate estimate{spread_of(context, weights, poses), std::nullopt};
      if (has_mixture) estimate.mixture = mixture_of(context, weights, posterior_);
      return estimate;
    }
    if (!moments_) moments_.emplace(context, weights, poses);
    PoseEstimate estimate{moments_->moved_by(motion_), std::nullopt};
    if (has_mixture) estimate.mixture = estimate.spread;
    return estimate;
  }

  const SensorNoise& noise() const { return noise_; }

 protected:
  // The next functions are flattened; otherwise their arrays of registers pass through memory.

  /// Updates `pose` with the scan of block b, one detection after the other.
  template <class Associating, class Innovations>
  [[gnu::flatten]] void update_with_scan(const Associating& association, std::size_t b,
                                         PoseGaussian<Real>& pose, const Innovations& innovations,
                                         Evidence<Real>& evidence) const {
    for (std::size_t k = 0; k < association.matches(); ++k) {
      const auto& [landmark, seen, mask] = association.match(b, k);
      innovations.add(
          k, pose_transform_.refine(pose, gaussian_of(landmark), seen, noise_, mask, evidence),
          mask);
    }
  }
  /// Updates the landmarks of block b with the scan from `pose`.
  template <class Associating, class Weighed>
  [[gnu::flatten]] void update_landmarks(const Associating& association, std::size_t b,
                                         const BasicPose<Real>& pose, Weighed& evidence) const {
    for (std::size_t k = 0; k < association.matches(); ++k) {
      auto match = association.match(b, k);
      map_transform_.update(match.landmark, pose, match.seen, noise_, match.mask, evidence);
      association.store(b, k, match);
    }
  }
  /// Keeps the Gaussians of the poses of block b before they are drawn.
  void keep(std::size_t b, const PoseGaussian<Real>& posterior) { posterior_[b] = posterior; }
  const PoseTransform& pose_transform() const { return pose_transform_; }

  static StreamIdentity identity(const StepContext& context, Draw purpose, std::size_t b) {
    return context.identity(purpose, static_cast<std::uint32_t>(b * kLanesOf<Real>));
  }

 private:
  Belief belief_;
  SensorNoise noise_;
  PoseTransform pose_transform_;
  MapTransform map_transform_;
  WeightTime weighed_;
  MotionIncrement motion_;
  std::vector<PoseGaussian<Real>> posterior_;    ///< Gaussians of the last scan before the draw
  mutable std::optional<CloudMoments> moments_;  ///< moments of the poses, computed on demand
  bool is_drawn_ = false;
};

/// The three forms of the weight of FastSLAM II (EQUATIONS 6).
enum class WeightForm {
  closed,  ///< product of N(innovation; S), each before the update with its detection
  ratio,   ///< likelihood times prior over proposal at the drawn pose
  batch,   ///< N of the stacked innovation, linearised at the predicted pose; only for `Linearised`
};

/// Refines the predicted pose by the scan before it is drawn (EQUATIONS 6, 7, 8).
template <class Real, class PoseTransform, class MapTransform>
class GaussianProposal : public RefinedCloud<Real, PoseTransform, MapTransform> {
 public:
  using Cloud = RefinedCloud<Real, PoseTransform, MapTransform>;

  /// A pose between prediction and draw.
  struct Refined {
    PoseGaussian<Real> predicted, posterior;
    Evidence<Real> evidence;  ///< evidence of the scan before the draw
    Real faults;
  };

  GaussianProposal(std::size_t particles, const Belief& belief, WeightForm form,
                   const PoseTransform& pose_transform, const MapTransform& map_transform)
      : Cloud(particles, belief, time_of(form), pose_transform, map_transform), form_(form) {}

  template <class Associating, class Innovations>
  Refined refine(const StepContext& /*context*/, std::size_t b, const PoseGaussian<Real>& predicted,
                 const Associating& association, const Innovations& innovations) const {
    PoseGaussian<Real> posterior = predicted;
    Evidence<Real> evidence;
    this->update_with_scan(association, b, posterior, innovations, evidence);
    const Real faults = evidence.left_out();
    if (form_ == WeightForm::batch) evidence = batch_evidence(association, b, predicted);
    return {predicted, posterior, evidence, faults};
  }

  /// This is one function, so that the factor and the normals can be computed in parallel.
  [[gnu::flatten]] BasicPose<Real> draw(const StepContext& context, std::size_t b,
                                        Refined& refined) {
    const PoseFactor<Real> factor(refined.posterior);
    refined.faults += factor.L.faults;
    this->keep(b, refined.posterior);
    return draw_from(factor, Cloud::identity(context, Draw::pose_proposal, b));
  }

  /// Updates the landmarks and returns the log of the weight's factor.
  template <class Associating, class Innovations>
  Weighing<Real> update_map(std::size_t b, const BasicPose<Real>& pose,
                            const Associating& association, Refined& refined,
                            const Innovations& /*innovations*/) const {
    if (form_ != WeightForm::ratio) {
      Unweighed<Real> unweighed;
      this->update_landmarks(association, b, pose, unweighed);
      return {refined.evidence.log_density(), refined.faults};
    }
    Evidence<Real> drawn;
    this->update_landmarks(association, b, pose, drawn);
    const Real ratio =
        PoseDensity<Real>(refined.predicted)(pose) - PoseDensity<Real>(refined.posterior)(pose);
    return {drawn.log_density() + ratio, refined.faults};
  }

 private:
  static WeightTime time_of(WeightForm form) {
    return form == WeightForm::ratio ? WeightTime::after_draw : WeightTime::before_draw;
  }
  /// The evidence of form batch, empty for a transform that does not support it.
  template <class Associating>
  Evidence<Real> batch_evidence(const Associating& association, std::size_t b,
                                const PoseGaussian<Real>& predicted) const {
    Evidence<Real> evidence;
    if constexpr (PoseTransform::kRefinesInBatch) {
      PoseGaussian<Real> refined = predicted;
      for (std::size_t k = 0; k < association.matches(); ++k) {
        const auto& [landmark, seen, mask] = association.match(b, k);
        this->pose_transform().refine_in_batch(refined, predicted.mean, gaussian_of(landmark), seen,
                                               this->noise(), mask, evidence);
      }
    }
    return evidence;
  }

  WeightForm form_;
};

}  // namespace montecarta::filters
