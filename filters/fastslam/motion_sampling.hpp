// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/particles/block_tasks.hpp"
#include "engine/random/normals.hpp"
#include "filters/fastslam/drawn_poses.hpp"
#include "filters/models/ackermann.hpp"
#include "filters/moments/linearised.hpp"
#include "filters/population/cloud_moments.hpp"

#include <vector>

namespace montecarta {

/// FastSLAM I (SPEC 6): every particle moves with control noise of its own at every step; the scan
/// only weighs it.
template <class Real>
class MotionSampling : public DrawnPoses<Real> {
 public:
  explicit MotionSampling(const Belief& belief)
      : DrawnPoses<Real>(SensorNoise::of(belief)), belief_(belief) {}

  void start(const std::vector<BasicPose<Real>>& /*poses*/) {}

  void predict(const StepContext& context, const Control& control, double duration,
               const Weights<Real>& /*weights*/, std::vector<BasicPose<Real>>& poses) {
    constexpr std::size_t kBlocksPerTask = 1024 / kLanesOf<Real>;
    BlockTasks<Real>(poses.size(), kBlocksPerTask)
        .run(context, [&](std::size_t /*task*/, std::size_t b) {
          poses[b] = moved(context, control, duration, b, poses[b]);
        });
  }
  /// The pose is certain within a particle.
  PoseGaussian<Real> predicted(std::size_t /*b*/, const BasicPose<Real>& pose) const {
    return {pose, {}};
  }

  template <class Matches, class Maps>
  void prepare(const StepContext& /*context*/, const Matches& /*matches*/,
               const Weights<Real>& /*weights*/, const std::vector<BasicPose<Real>>& /*poses*/,
               Maps& /*maps*/) {}

  /// Weighs one block by the likelihood at its poses and updates its landmarks.
  template <class Matches, class Note>
  Weighing<Real> weigh_and_draw(const StepContext& /*context*/, const Matches& matches,
                                std::size_t b, const BasicPose<Real>& pose, const Note& note) {
    Evidence<Real> likelihood;
    matches.read(b, [](auto&&...) {});
    matches.update(b, [&](std::size_t k, auto& landmark, const auto& seen, const auto& mask) {
      note(k, update_landmark(landmark, pose, seen, this->noise(), mask, likelihood), mask);
    });
    return {likelihood.log_density(), likelihood.left_out()};
  }
  LandmarkGaussian<Real> birth(std::size_t /*b*/, const BasicPose<Real>& pose,
                               const RangeBearing<Real>& seen) const {
    return new_landmark(pose, seen, this->noise());
  }
  void end_scan() {}
  void settle() {}
  PoseEstimate estimate(const Weights<Real>& weights,
                        const std::vector<BasicPose<Real>>& poses) const {
    return {spread_of(weights, poses), std::nullopt};
  }

 private:
  BasicPose<Real> moved(const StepContext& context, const Control& control, double duration,
                        std::size_t b, const BasicPose<Real>& pose) const {
    const auto first = static_cast<std::uint32_t>(b * kLanesOf<Real>);
    const auto [e0, e1] = normal_pairs<Real>(context.identity(Draw::motion_sample, first), 0);
    const Real speed = control.speed + belief_.sigma_speed * e0;
    const Real steer = control.steer + belief_.sigma_steer * e1;
    return move(pose, speed, steer, duration, belief_.vehicle);
  }

  Belief belief_;
};

}  // namespace montecarta
