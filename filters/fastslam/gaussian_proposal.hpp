// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/fast_slam_options.hpp"
#include "filters/fastslam/refined_cloud.hpp"
#include "filters/moments/gaussian_draw.hpp"

#include <type_traits>

namespace montecarta {

/// The predicted pose is refined by the scan before it is drawn (EQUATIONS 6 to 8).
template <class Real, class PoseTransform, class MapTransform>
class GaussianProposal : public RefinedCloud<Real, PoseTransform, MapTransform> {
 public:
  using Cloud = RefinedCloud<Real, PoseTransform, MapTransform>;
  GaussianProposal(std::size_t particles, const Belief& belief, WeightForm form,
                   const PoseTransform& pose_transform, const MapTransform& map_transform)
      : Cloud(particles, belief, pose_transform, map_transform), form_(form) {}

  /// Nothing is to be decided for all particles together.
  template <class Matches, class Maps>
  void prepare(const StepContext& /*context*/, const Matches& /*matches*/,
               const Weights<Real>& /*weights*/, const std::vector<BasicPose<Real>>& /*poses*/,
               Maps& /*maps*/) {}

  /// Refines, draws and weighs one block and updates its landmarks; returns the log of the weight's
  /// factor.
  template <class Matches, class Note>
  Weighing<Real> weigh_and_draw(const StepContext& context, const Matches& matches, std::size_t b,
                                BasicPose<Real>& pose, const Note& note) {
    const PoseGaussian<Real> prior = this->predicted(b, pose);
    PoseGaussian<Real> posterior = prior;
    Evidence<Real> closed, drawn;
    this->refine(matches, b, posterior, closed, note);
    const Real batch = form_ == WeightForm::batch ? batch_log_weight(matches, b, prior) : Real(0.0);
    const PoseFactor<Real> factor(posterior);
    pose = draw_from(factor, context.identity(Draw::pose_proposal,
                                              static_cast<std::uint32_t>(b * kLanesOf<Real>)));
    Unweighed<Real> unweighed;
    form_ == WeightForm::ratio ? this->update_landmarks(matches, b, pose, drawn)
                               : this->update_landmarks(matches, b, pose, unweighed);
    this->keep(b, posterior);
    const Real faults = closed.left_out() + factor.L.faults;
    switch (form_) {
      case WeightForm::closed:
        return {closed.log_density(), faults};
      case WeightForm::batch:
        return {batch, faults};
      case WeightForm::ratio:
        break;
    }
    const Real ratio = PoseDensity<Real>(prior)(pose) - PoseDensity<Real>(posterior)(pose);
    return {drawn.log_density() + ratio, faults};
  }

 private:
  /// Of linearised poses only; the other filters do not offer it.
  template <class Matches>
  Real batch_log_weight(const Matches& matches, std::size_t b,
                        const PoseGaussian<Real>& prior) const {
    Evidence<Real> evidence;
    if constexpr (std::is_same_v<PoseTransform, Linearised>) {
      PoseGaussian<Real> refined = prior;
      matches.read(b, [&](std::size_t, const auto& landmark, const auto& seen, const auto& mask) {
        refine_pose_in_batch(refined, prior.mean, landmark, seen, this->noise(), mask, evidence);
      });
    }
    return evidence.log_density();
  }

  WeightForm form_;
};

}  // namespace montecarta
