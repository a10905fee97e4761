// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/random/stream.hpp"
#include "filters/fastslam/concepts.hpp"
#include "filters/models/ackermann.hpp"

#include <vector>

namespace montecarta::filters {

/// FastSLAM I (EQUATIONS 5): every particle moves with its own noise of the control at every step.
/// The scan only changes its weight, by the likelihood at its pose.
template <class Real, KeepsLandmarks<Real> MapTransform>
class MotionSampling {
 public:
  using Landmark = LandmarkStateOf<MapTransform, Real>;
  using Refined = BasicPose<Real>;

  MotionSampling(const Belief& belief, const MapTransform& map_transform)
      : belief_(belief), noise_(SensorNoise::of(belief)), map_transform_(map_transform) {}

  void predict(const StepContext& context, const Control& control, double duration,
               std::vector<BasicPose<Real>>& poses) {
    const auto sigma = deviations_of(belief_.control, control, belief_.vehicle);
    const auto move_all = [&](const auto& vehicle) {
      BlockTasks<Real>(poses.size(), kTogether)
          .run_together(context, [&](std::size_t b, std::size_t n) {
            const auto first = static_cast<std::uint32_t>(b * kLanesOf<Real>);
            const StreamIdentity noise = context.identity(Draw::motion_sample, first);
            const auto block = std::span(poses).subspan(b, n);
            if (belief_.control.increment.is_none()) {
              sample_motion(vehicle, block, control, sigma, noise, duration);
            } else {
              sample_increments(vehicle, block, control, sigma, noise, duration);
            }
          });
    };
    std::visit(move_all, belief_.vehicle);
  }
  /// The pose of a particle is certain.
  PoseGaussian<Real> predicted(std::size_t /*b*/, const BasicPose<Real>& pose) const {
    return {pose, {}};
  }

  template <class Associating, class Innovations>
  Refined refine(const StepContext& /*context*/, std::size_t /*b*/,
                 const PoseGaussian<Real>& predicted, const Associating& /*association*/,
                 const Innovations& /*innovations*/) const {
    return predicted.mean;
  }
  BasicPose<Real> draw(const StepContext& /*context*/, std::size_t /*b*/, Refined& refined) const {
    return refined;
  }
  template <class Associating, class Innovations>
  [[gnu::flatten]] Weighing<Real> update_map(std::size_t b, const BasicPose<Real>& pose,
                                             const Associating& association, Refined& /*refined*/,
                                             const Innovations& innovations) const {
    Evidence<Real> likelihood;
    for (std::size_t k = 0; k < association.matches(); ++k) {
      auto match = association.match(b, k);
      innovations.add(
          k,
          map_transform_.update(match.landmark, pose, match.seen, noise_, match.mask, likelihood),
          match.mask);
      association.store(b, k, match);
    }
    return {likelihood.log_density(), likelihood.left_out()};
  }

  void initialise(const FreshLandmark<Real>& fresh, const BasicPose<Real>& pose,
                  ParticleMaps<Real, Landmark>& maps) const {
    fresh.put(map_transform_.initialise(pose, measurement_of<Real>(fresh.detection), noise_),
              maps.blocks_of(fresh.slot)[fresh.block]);
  }
  PoseEstimate estimate(const StepContext& context, const Weights<Real>& weights,
                        const std::vector<BasicPose<Real>>& poses) const {
    return {spread_of(context, weights, poses), std::nullopt};
  }

 private:
  static constexpr std::size_t kTogether = 1024 / kLanesOf<Real>;

  /// Moves `poses` by one control step, with different noise in each lane.
  template <class V>
  [[gnu::flatten]] static void sample_motion(const V& vehicle, std::span<BasicPose<Real>> poses,
                                             const Control& control,
                                             const std::array<double, Control::kMost>& sigma,
                                             const StreamIdentity& noise, double duration) {
    constexpr std::size_t kPairs = (kControlsOf<V> + 1) / 2;
    std::array<std::array<Pair<Real>, kTogether>, kPairs> e;
    for (std::uint32_t k = 0; k < kPairs; ++k)
      fill_normal_pairs(std::span(e[k]).first(poses.size()), noise, k);
    for (std::size_t b = 0; b < poses.size(); ++b) {
      ControlOf<Real> sample{control[0] + sigma[0] * e[0][b].first,
                             control[1] + sigma[1] * e[0][b].second, Real(0.0)};
      if constexpr (kPairs > 1) sample[2] = control[2] + sigma[2] * e[1][b].first;
      poses[b] = moved_by(poses[b], body_step_of(vehicle, sample, duration));
    }
  }

  /// Does the same with noise of the step, too, whose numbers follow those of the controls.
  template <class V>
  void sample_increments(const V& vehicle, std::span<BasicPose<Real>> poses, const Control& control,
                         const std::array<double, Control::kMost>& sigma,
                         const StreamIdentity& noise, double duration) const {
    constexpr std::size_t kPairs = (kControlsOf<V> + 1) / 2;
    const IncrementNoise& increment = belief_.control.increment;
    const std::array<double, 3> deviations =
        increment_deviations(increment, body_step(belief_.vehicle, control, duration), duration);
    std::array<std::array<Pair<Real>, kTogether>, kPairs + 2> e;
    for (std::uint32_t k = 0; k < e.size(); ++k)
      fill_normal_pairs(std::span(e[k]).first(poses.size()), noise, k);
    for (std::size_t b = 0; b < poses.size(); ++b) {
      ControlOf<Real> sample{control[0] + sigma[0] * e[0][b].first,
                             control[1] + sigma[1] * e[0][b].second, Real(0.0)};
      if constexpr (kPairs > 1) sample[2] = control[2] + sigma[2] * e[1][b].first;
      const BodyStep<Real> step = body_step_of(vehicle, sample, duration);
      const std::array<Real, 3> normals{e[kPairs][b].first, e[kPairs][b].second,
                                        e[kPairs + 1][b].first};
      poses[b] = moved_by(poses[b], perturbed(step, increment.model, deviations, normals));
    }
  }

  Belief belief_;
  SensorNoise noise_;
  MapTransform map_transform_;
};

}  // namespace montecarta::filters
