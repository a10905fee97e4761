// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/concepts.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

namespace montecarta::filters {

/// Rao-Blackwellised particle filter with one map per particle (EQUATIONS 4). `Real` is double or
/// Lanes. Between update() and the next predict() the particles are weighted and drawn but not yet
/// resampled. Estimates and records show that state.
template <class Real, class Proposal, class Associating>
requires Associator<Associating, Real> && PoseProposal<Proposal, Real, Associating>
class FastSlam final : public SlamFilter {
 public:
  /// `belief` has the sensor of the detections and the deviation of fixes.
  FastSlam(const PopulationSettings& settings, const Belief& belief, Proposal proposal,
           Associating association)
      : components_(components_of(belief.sensor).size()),
        sigma_fix_(belief.sigma_fix),
        proposal_(std::move(proposal)),
        association_(std::move(association)),
        population_(settings),
        poses_(population_.blocks()),
        resampled_poses_(poses_.size()),
        predicted_(poses_.size()),
        maps_(settings.particles) {}

  void start(const Pose& start) override {
    start_from(StepContext::before_all_steps(), {.pose = {start}});
  }
  /// Particles begin with the prior of the pose as their Gaussian or, if they have none, are drawn
  /// from it. All have the known map.
  void start_from(const StepContext& context, const Prior& prior) override {
    now_ = context;
    fix_.reset();
    population_.start();
    maps_.clear();
    association_.start();
    if constexpr (KeepsGaussians<Proposal>) {
      draw_start(context, {.mean = prior.pose.mean}, poses_);
      proposal_.start(prior.pose);
    } else {
      draw_start(context, prior.pose, poses_);
    }
    association_.add_known(context, prior.map, maps_);
  }

  void predict(const StepContext& context, const Control& control, double duration) override {
    now_ = context;
    resample();
    proposal_.predict(context, control, duration, poses_);
  }

  void take_fix(const PositionFix& fix) override { fix_ = fix; }

  void update(const StepContext& context, Scan scan) override {
    now_ = context;
    resample();
    population_.begin_scan();
    if constexpr (HasOwnColumns<Proposal>) {
      proposal_.begin_report();
      population_.report().own = proposal_.own_columns();
    }
    predict_poses(context);
    if (fix_) use_fix(context);
    association_.associate(context, scan, maps_, predicted_);
    const bool found = fix_ || !association_.matched_nothing();
    if (found) weigh_and_draw(context);
    fix_.reset();
    population_.report().association = association_.counts(weights());
    if (found) initialise_landmarks(context);
    population_.report().map_size = association_.map_size(maps_, weights());
    if (found) population_.decide_on_resampling(context);
  }

  PoseEstimate estimate() const override { return proposal_.estimate(now_, weights(), poses_); }
  const ScanReport& report() const override { return population_.report(); }
  void particles(const ParticleColumns& columns) const override {
    const auto mean_of = [&](std::size_t b) { return proposal_.predicted(b, poses_[b]).mean; };
    population_.write_columns(columns,
                              [&](std::size_t i) { return pose_of_particle<Real>(mean_of, i); });
  }
  void map(std::span<std::optional<LandmarkEstimate>> landmarks) const override {
    for (std::size_t j = 0; j < landmarks.size(); ++j)
      landmarks[j] = association_.landmark(now_, j, maps_, weights());
  }

 private:
  const Weights<Real>& weights() const { return population_.weights(); }

  void predict_poses(const StepContext& context) {
    BlockTasks<Real>(poses_.size()).run(context, [&](std::size_t /*task*/, std::size_t b) {
      predicted_[b] = proposal_.predicted(b, poses_[b]);
    });
  }

  /// Conditions the predicted poses on the fix of the position, which is linear (EQUATIONS (24.1)).
  void use_fix(const StepContext& context) {
    const double variance = sigma_fix_.value() * sigma_fix_.value();
    log_weights_of_fix_.resize(poses_.size());
    BlockTasks<Real>(poses_.size()).run(context, [&](std::size_t /*task*/, std::size_t b) {
      log_weights_of_fix_[b] = update_with_fix(predicted_[b], *fix_, variance);
    });
  }

  void weigh_and_draw(const StepContext& context) {
    const BlockTasks<Real> tasks(poses_.size());
    innovations_.start(context, tasks.count(), association_.matches());
    for (std::size_t k = 0; k < association_.matches(); ++k)
      innovations_.matched_weight(k) = association_.matched_weight(k, weights());
    if constexpr (PreparesScan<Proposal, Real, Associating>)
      proposal_.prepare(context, association_, weights(), predicted_);
    tasks.run(context,
              [&](std::size_t task, std::size_t b) { weigh_and_draw_block(context, task, b); });
    if constexpr (KeepsGaussians<Proposal>) proposal_.end_scan();
    population_.normalise(context);
    innovations_.add_to(context, population_.report(), components_);
  }

  void weigh_and_draw_block(const StepContext& context, std::size_t task, std::size_t b) {
    const auto innovations = innovations_.of_block(task, weights().linear()[b]);
    association_.fetch(b);
    auto refined = proposal_.refine(context, b, predicted_[b], association_, innovations);
    poses_[b] = proposal_.draw(context, b, refined);
    const Weighing<Real> weighing =
        proposal_.update_map(b, poses_[b], association_, refined, innovations);
    Real log_weight = weighing.log_weight + association_.unmatched_log_weight(b);
    if (fix_) log_weight += log_weights_of_fix_[b];
    population_.weigh(b, {log_weight, weighing.faults});
  }

  void initialise_landmarks(const StepContext& context) {
    if constexpr (requires { association_.initialise(context, maps_, poses_); })
      return association_.initialise(context, maps_, poses_);
    const std::span<const FreshLandmark<Real>> fresh = association_.new_landmarks(context, maps_);
    BlockTasks<Real>(fresh.size()).run(context, [&](std::size_t /*task*/, std::size_t k) {
      proposal_.initialise(fresh[k], poses_[fresh[k].block], maps_);
    });
  }

  /// Applies the pending resampling. The particles of the last scan are gone afterwards.
  void resample() {
    if (!population_.is_after_scan()) return;
    if (population_.resample(now_)) {
      const std::span<const std::uint32_t> parents = population_.ancestors();
      gather<Real>(now_, poses_, parents, resampled_poses_);
      std::swap(poses_, resampled_poses_);
      maps_.resample(now_, parents);
      association_.resample(now_, parents);
    }
    if constexpr (KeepsGaussians<Proposal>) proposal_.begin_step();
  }

  StepContext now_ = StepContext::before_all_steps();  ///< the present step, with its threads
  std::size_t components_;                             ///< number of components of a detection
  std::optional<double> sigma_fix_;                    ///< [m] deviation of a fix of the position
  std::optional<PositionFix> fix_;                     ///< fix for the next scan
  std::vector<Real> log_weights_of_fix_;
  Proposal proposal_;
  Associating association_;
  Population<Real> population_;
  std::vector<BasicPose<Real>> poses_, resampled_poses_;
  std::vector<PoseGaussian<Real>> predicted_;  ///< {block} poses predicted by the motion, at a scan
  typename Associating::Maps maps_;
  MixtureInnovations<Real> innovations_;
};

}  // namespace montecarta::filters
