// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/random/normals.hpp"
#include "filters/fastslam/fast_slam_options.hpp"
#include "filters/moments/cloud_moments.hpp"
#include "filters/moments/linearised.hpp"
#include "filters/moments/motion_increment.hpp"

#include <optional>
#include <vector>

namespace montecarta {

/// FastSLAM II (SPEC 7): the predicted pose is refined by the scan before it is drawn.
template <class Real>
class GaussianProposal {
 public:
  GaussianProposal(std::size_t particles, const Belief& belief, WeightForm form)
      : belief_(belief),
        noise_(SensorNoise::of(belief)),
        form_(form),
        posterior_(blocks_for<Real>(particles)) {}

  void start(const std::vector<BasicPose<Real>>& /*poses*/) {
    motion_.restart();
    settle();
  }
  void predict(const StepContext& /*context*/, const Control& control, double duration,
               const Weights<Real>& /*weights*/, std::vector<BasicPose<Real>>& /*poses*/) {
    motion_.advance(control, duration, belief_);
  }
  PoseGaussian<Real> predicted(const BasicPose<Real>& drawn) const { return motion_.from(drawn); }

  /// Refines, draws and weighs one block and updates its landmarks; returns the log of the weight's
  /// factor.
  template <class Matches, class Note>
  Weighing<Real> weigh_and_draw(const StepContext& context, const Matches& matches, std::size_t b,
                                BasicPose<Real>& pose, const Note& note) {
    const PoseGaussian<Real> prior = motion_.from(pose);
    PoseGaussian<Real> posterior = prior;
    Evidence<Real> closed, drawn;
    matches.read(b, [&](std::size_t k, const auto& landmark, const auto& seen, const auto& mask) {
      note(k, refine_pose(posterior, landmark, seen, noise_, mask, closed), mask);
    });
    const Real batch = form_ == WeightForm::batch ? batch_log_weight(matches, b, prior) : Real(0.0);
    Real faults(0.0);
    pose = draw(context, b, posterior, faults);
    const auto update_landmarks = [&](auto& evidence) {
      matches.update(b, [&](std::size_t, auto& landmark, const auto& seen, const auto& mask) {
        update_landmark(landmark, pose, seen, noise_, mask, evidence);
      });
    };
    Unweighed<Real> unweighed;
    form_ == WeightForm::ratio ? update_landmarks(drawn) : update_landmarks(unweighed);
    posterior_[b] = posterior;
    faults += closed.left_out();
    switch (form_) {
      case WeightForm::closed:
        return {closed.log_density(), faults};
      case WeightForm::batch:
        return {batch, faults};
      case WeightForm::ratio:
        break;
    }
    return {drawn.log_density() + log_density(prior, pose) - log_density(posterior, pose), faults};
  }

  LandmarkGaussian<Real> birth(const BasicPose<Real>& pose, const RangeBearing<Real>& seen) const {
    return new_landmark(pose, seen, noise_);
  }
  /// All poses were drawn: nothing is uncertain within a particle.
  void end_scan() {
    motion_.restart();
    is_drawn_ = true;
  }
  void settle() {
    moments_.reset();
    is_drawn_ = false;
  }
  PoseEstimate estimate(const Weights<Real>& weights,
                        const std::vector<BasicPose<Real>>& poses) const {
    if (is_drawn_) return {spread_of(weights, poses), mixture_of(weights, posterior_)};
    if (!moments_) moments_.emplace(weights, poses);
    return moments_->moved_by(motion_);
  }

 private:
  template <class Matches>
  Real batch_log_weight(const Matches& matches, std::size_t b,
                        const PoseGaussian<Real>& prior) const {
    PoseGaussian<Real> refined = prior;
    Evidence<Real> evidence;
    matches.read(b, [&](std::size_t, const auto& landmark, const auto& seen, const auto& mask) {
      refine_pose_in_batch(refined, prior.mean, landmark, seen, noise_, mask, evidence);
    });
    return evidence.log_density();
  }

  /// The factor is that in the frame of the vehicle, so that a turned world gives a turned draw.
  static BasicPose<Real> draw(const StepContext& context, std::size_t b,
                              const PoseGaussian<Real>& from, Real& faults) {
    const StreamIdentity identity =
        context.identity(Draw::pose_proposal, static_cast<std::uint32_t>(b * kLanesOf<Real>));
    const auto [e0, e1] = normal_pairs<Real>(identity, 0);
    const Real e2 = normal_pairs<Real>(identity, 1).first;
    const Direction<Real> ahead = direction_of(from.mean.heading);
    const Cholesky3<Real> L(turned(from.covariance, {ahead.cosine, -ahead.sine}));
    faults += L.faults;
    const Real x = L.xx * e0, y = L.yx * e0 + L.yy * e1;
    return {from.mean.x + ahead.cosine * x - ahead.sine * y,
            from.mean.y + ahead.sine * x + ahead.cosine * y,
            wrap(from.mean.heading + L.hx * e0 + L.hy * e1 + L.hh * e2)};
  }

  /// log N(pose; gaussian), the covariance made invertible by 1e-12 m^2 and 1e-14 rad^2 (SPEC 7.2
  /// r).
  static Real log_density(const PoseGaussian<Real>& gaussian, const BasicPose<Real>& pose) {
    Symmetric3<Real> P = gaussian.covariance;
    P.xx += Real(1e-12), P.yy += Real(1e-12), P.hh += Real(1e-14);
    const Cholesky3<Real> L(P);
    const Real a = (pose.x - gaussian.mean.x) / L.xx;
    const Real b = (pose.y - gaussian.mean.y - L.yx * a) / L.yy;
    const Real h = (wrap(pose.heading - gaussian.mean.heading) - L.hx * a - L.hy * b) / L.hh;
    return -0.5 * (a * a + b * b + h * h) - log(L.xx * L.yy * L.hh);  // 2 pi cancels in the ratio
  }

  Belief belief_;
  SensorNoise noise_;
  WeightForm form_;
  MotionIncrement motion_;
  std::vector<PoseGaussian<Real>> posterior_;  ///< of the last scan, before drawing
  mutable std::optional<CloudMoments>
      moments_;  ///< of the poses since the last scan, once asked for
  bool is_drawn_ = false;
};

}  // namespace montecarta
