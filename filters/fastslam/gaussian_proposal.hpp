// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/refined_cloud.hpp"

namespace montecarta::filters {

/// The three ways to weigh a particle of FastSLAM II (EQUATIONS 6).
enum class WeightForm {
  closed,  ///< product of N(innovation; S), each before the update with the detection
  ratio,   ///< likelihood times prior over proposal at the drawn pose
  batch,   ///< N of the stacked innovation, linearised at the predicted pose: `Linearised` only
};

/// The predicted pose is refined by the scan before it is drawn (EQUATIONS 6, 7, 8).
template <class Real, class PoseTransform, class MapTransform>
class GaussianProposal : public RefinedCloud<Real, PoseTransform, MapTransform> {
 public:
  using Cloud = RefinedCloud<Real, PoseTransform, MapTransform>;

  /// A pose on its way from the prediction to the draw.
  struct Refined {
    PoseGaussian<Real> predicted, posterior;
    Evidence<Real> evidence;  ///< of the scan, before the draw
    Real faults;
  };

  GaussianProposal(std::size_t particles, const Belief& belief, WeightForm form,
                   const PoseTransform& pose_transform, const MapTransform& map_transform)
      : Cloud(particles, belief, time_of(form), pose_transform, map_transform), form_(form) {}

  /// Nothing is to be decided for all particles together.
  template <class Associating>
  void prepare(const StepContext& /*context*/, const Associating& /*association*/,
               const Weights<Real>& /*weights*/,
               const std::vector<PoseGaussian<Real>>& /*predicted*/) {}

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

  /// One function: its factor and its normals do not wait for each other.
  [[gnu::flatten]] BasicPose<Real> draw(const StepContext& context, std::size_t b,
                                        Refined& refined) {
    const PoseFactor<Real> factor(refined.posterior);
    refined.faults += factor.L.faults;
    this->keep(b, refined.posterior);
    return draw_from(factor, Cloud::identity(context, Draw::pose_proposal, b));
  }

  /// Updates the landmarks, and returns the log of the weight's factor.
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
  /// Only of a transform that offers it.
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
