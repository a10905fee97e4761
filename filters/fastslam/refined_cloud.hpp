// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/drawn_poses.hpp"
#include "filters/moments/moment_transforms.hpp"
#include "filters/population/cloud_moments.hpp"

#include <optional>
#include <vector>

namespace montecarta {

/// What filters have in common whose poses are drawn from Gaussians that the scan refined (SPEC 5):
/// prediction, refinement, maps, and the estimate between scans. The transforms carry the
/// Gaussians: `PoseTransform` those of the pose, `MapTransform` those of the landmarks.
template <class Real, class PoseTransform, class MapTransform>
class RefinedCloud : public DrawnPoses<Real> {
 public:
  RefinedCloud(std::size_t particles, const Belief& belief, const PoseTransform& pose_transform,
               const MapTransform& map_transform)
      : DrawnPoses<Real>(SensorNoise::of(belief)),
        belief_(belief),
        pose_transform_(pose_transform),
        map_transform_(map_transform),
        posterior_(blocks_for<Real>(particles)) {}

  void start(const std::vector<BasicPose<Real>>& /*poses*/) {
    motion_.restart();
    settle();
  }
  void predict(const StepContext& /*context*/, const Control& control, double duration,
               const Weights<Real>& /*weights*/, std::vector<BasicPose<Real>>& /*poses*/) {
    pose_transform_.advance(motion_, control, duration, belief_);
  }
  PoseGaussian<Real> predicted(std::size_t /*b*/, const BasicPose<Real>& drawn) const {
    return motion_.from(drawn);
  }
  LandmarkGaussian<Real> birth(std::size_t /*b*/, const BasicPose<Real>& pose,
                               const RangeBearing<Real>& seen) const {
    return map_transform_.birth(pose, seen, this->noise());
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

 protected:
  /// Absorbs the scan of block b into `pose`, one detection after the other.
  template <class Matches, class Note>
  void refine(const Matches& matches, std::size_t b, PoseGaussian<Real>& pose,
              Evidence<Real>& evidence, const Note& note) const {
    matches.read(b, [&](std::size_t k, const auto& landmark, const auto& seen, const auto& mask) {
      note(k, pose_transform_.refine(pose, landmark, seen, this->noise(), mask, evidence), mask);
    });
  }
  /// Absorbs the scan into the landmarks of block b, seen from `pose`.
  template <class Matches, class Weighed>
  void update_landmarks(const Matches& matches, std::size_t b, const BasicPose<Real>& pose,
                        Weighed& evidence) const {
    matches.update(b, [&](std::size_t, auto& landmark, const auto& seen, const auto& mask) {
      map_transform_.update(landmark, pose, seen, this->noise(), mask, evidence);
    });
  }
  /// What the particles of block b believed of their poses before they were drawn.
  void keep(std::size_t b, const PoseGaussian<Real>& posterior) { posterior_[b] = posterior; }

  MotionIncrement& motion() { return motion_; }
  const MotionIncrement& motion() const { return motion_; }

 private:
  Belief belief_;
  PoseTransform pose_transform_;
  MapTransform map_transform_;
  MotionIncrement motion_;
  std::vector<PoseGaussian<Real>> posterior_;  ///< of the last scan, before drawing
  mutable std::optional<CloudMoments>
      moments_;  ///< of the poses since the last scan, once asked for
  bool is_drawn_ = false;
};

}  // namespace montecarta
