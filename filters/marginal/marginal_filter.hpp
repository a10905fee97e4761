// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/marginal/kernel_sums.hpp"
#include "filters/marginal/map_learning.hpp"
#include "filters/setup/filter_kind.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

namespace montecarta::filters {

/// Marginal and auxiliary marginal particle filter with one map for all particles (EQUATIONS 12,
/// 14; Havangi). `Real` is double or Lanes.
template <class Real>
class MarginalFilter final : public SlamFilter {
 public:
  MarginalFilter(const FilterSetup& setup, const MarginalSettings& settings)
      : settings_(settings),
        belief_(setup.belief),
        association_(setup),
        likelihood_(SensorNoise::of(setup.belief), settings.map.mode),
        learning_(settings.map, SensorNoise::of(setup.belief)),
        ratios_(settings),
        population_({.particles = settings.particles, .resampling = Resampling::stratified}),
        lambda_(settings.particles),
        poses_(population_.blocks()),
        priors_(poses_.size()),
        kernels_(poses_.size()) {}

  void start(const Pose& start) override {
    start_from(StepContext::before_all_steps(), {.pose = {start}});
  }
  /// Particles are drawn from the prior of the pose. They share the known map.
  void start_from(const StepContext& context, const Prior& prior) override {
    now_ = context;
    draw_start(context, prior.pose, poses_);
    population_.start();
    map_.clear();
    association_.clear();
    for (const LandmarkEstimate& known : prior.map) {
      association_.add(static_cast<std::int32_t>(map_.size()));
      map_.push_back(given_landmark(known));
    }
    motion_.restart();
    forget_scan();
  }

  void predict(const StepContext& context, const Control& control, double duration) override {
    now_ = context;
    if (is_drawn_) forget_scan();
    motion_.advance(control, duration, belief_);
  }

  void update(const StepContext& context, Scan scan) override {
    now_ = context;
    forget_scan();
    propagate_kernels();
    associate(scan);
    population_.begin_scan();
    population_.report().association = association_.counts();
    report_.begin_scan();
    if (learning_.evolves()) population_.report().own = report_.values();
    if (!association_.matched_nothing()) learn(context);  // otherwise the kernels keep growing
    population_.report().map_size = static_cast<double>(map_.size());
  }

  /// The drawn poses, moved between scans by the motion since then like the kernels (EQUATIONS 19).
  PoseEstimate estimate() const override {
    if (is_drawn_) return {spread_of(now_, weights(), poses_), std::nullopt};
    if (!moments_) moments_.emplace(now_, weights(), poses_);
    return {moments_->moved_by(motion_), std::nullopt};
  }
  const ScanReport& report() const override { return population_.report(); }
  void particles(const ParticleColumns& columns) const override {
    const auto drawn = [&](std::size_t b) { return poses_[b]; };
    population_.write_columns(columns, [&](std::size_t i) {
      return motion_.from(pose_of_particle<Real>(drawn, i)).mean;
    });
  }
  void map(std::span<std::optional<LandmarkEstimate>> landmarks) const override {
    for (std::size_t k = 0; k < landmarks.size(); ++k) {
      const std::size_t slot = association_.slot_of(k);
      landmarks[k] = slot < map_.size() ? std::optional(estimate_of(map_[slot])) : std::nullopt;
    }
  }

 private:
  const Weights<Real>& weights() const { return population_.weights(); }

  void learn(const StepContext& context) {
    likelihood_.see(association_.matches(), map_);
    choose_kernels(context);
    draw_poses(context);
    weigh(context);
    learn_map(context);
    motion_.restart();
    is_drawn_ = true;
  }
  /// Computes p(s | s_j) from the motion since the last draw and the floor (EQUATIONS (12.1)).
  void propagate_kernels() {
    for (std::size_t b = 0; b < poses_.size(); ++b) {
      priors_[b] = motion_.from(poses_[b]);
      add_floor(priors_[b].covariance);
    }
  }
  void add_floor(Symmetric3<Real>& C) const {
    const double xy = std::max(settings_.kernel_floor_xy, 1e-5);            // [m]
    const double heading = std::max(settings_.kernel_floor_heading, 1e-6);  // [rad]
    C.xx += Real(xy * xy), C.yy += Real(xy * xy), C.hh += Real(heading * heading);
  }

  void associate(Scan scan) {
    if (association_.known()) return association_.associate(scan);
    association_.associate(scan, map_, likelihood_.map_is_exact(),
                           mixture_of(now_, weights(), priors_));
  }

  /// Step 1 computes lambda_j (EQUATIONS (12.2)); the auxiliary filter includes the likelihood.
  void choose_kernels(const StepContext& context) {
    innovations_.start(context, kernels_.size(), likelihood_.matches());
    lambda_ = weights();
    over_blocks(context, [&](std::size_t b) {
      const auto innovations = innovations_.of_block(b, weights().linear()[b]);
      const Weighing<Real> explained =
          settings_.kernel == Kernel::prior
              ? likelihood_.at_mean(priors_[b], innovations)
              : likelihood_.refine(kernels_[b] = priors_[b], innovations);
      if (settings_.choice == Choice::by_likelihood) lambda_.multiply(b, explained.log_weight);
    });
    if (settings_.choice == Choice::by_likelihood) lambda_.normalise(context);
    innovations_.add_to(context, population_.report());
  }
  const std::vector<PoseGaussian<Real>>& proposal() const {
    return settings_.kernel == Kernel::prior ? priors_ : kernels_;
  }

  /// Step 2 draws one pose per particle, from the same Gaussians that step 3 evaluates.
  void draw_poses(const StepContext& context) {
    population_.draw_ancestors(context, lambda_.linear_scalars());
    over_blocks(context, [&](std::size_t b) {
      const auto chosen =
          gather_block<Real, PoseGaussian<Real>>(proposal(), population_.ancestors(), b);
      const auto first = static_cast<std::uint32_t>(b * kLanesOf<Real>);
      poses_[b] = draw_from(PoseFactor<Real>(chosen), context.identity(Draw::kernel_sample, first));
    });
  }

  /// Steps 3 and 4 weight: w' = p(z | s) Sum w N(s; prior) / Sum lambda N(s; proposal).
  void weigh(const StepContext& context) {
    ratios_.assign(priors_, proposal(), weights(), lambda_);
    population_.weights().make_equal(context);
    over_blocks(context, [&](std::size_t b) { population_.weigh(b, likelihood_.at(poses_[b])); });
    ratios_.multiply(context, poses_, population_.weights());
    population_.normalise(context);
    population_.report().log_likelihood += association_.unmatched_log_densities();
  }

  /// Updates the shared map with the weighted poses (EQUATIONS 14).
  void learn_map(const StepContext& context) {
    const auto drawn = [&](std::size_t b) { return poses_[b]; };
    const double heading = weighted_mean<Real>(context, weights(), drawn).heading;
    for (const SharedMatch& match : association_.matches())
      learning_.learn(context, match.landmark, heading, poses_, weights(), match.seen,
                      map_[match.landmark], report_);
    report_.end_scan();
    for (const Detection& fresh : association_.fresh()) {
      association_.add(fresh.identity);
      map_.push_back(learning_.initialised(context, poses_, weights(), observation_of(fresh)));
    }
  }

  template <class Body>
  void over_blocks(const StepContext& context, const Body& body) {
    BlockTasks<Real>(poses_.size()).run(context, [&](std::size_t /*task*/, std::size_t b) {
      body(b);
    });
  }
  /// Discards the particles of the last scan, which are not available afterwards.
  void forget_scan() {
    population_.forget_ancestors();
    moments_.reset();
    is_drawn_ = false;
  }

  StepContext now_ = StepContext::before_all_steps();  ///< the present step, with its threads
  MarginalSettings settings_;
  Belief belief_;
  SharedAssociation association_;
  SharedLikelihood<Real> likelihood_;
  MapLearning<Real> learning_;
  EvolutionReport report_;  ///< on the evolution of the map; empty if nothing evolves
  KernelRatios<Real> ratios_;
  MotionIncrement motion_;
  Population<Real> population_;  ///< the particles, whose weights are w
  Weights<Real> lambda_;
  std::vector<BasicPose<Real>> poses_;      ///< drawn at the last scan that was used
  std::vector<PoseGaussian<Real>> priors_;  ///< {block} p(s | s_j)
  /// {block} p(s | s_j, z), if the proposal is the posterior.
  std::vector<PoseGaussian<Real>> kernels_;
  MixtureInnovations<Real> innovations_;
  SharedMap map_;
  mutable std::optional<CloudMoments> moments_;  ///< moments of the poses, computed on demand
  bool is_drawn_ = false;                        ///< true if the last update() drew the poses
};

/// With `Real` = double this is the same filter, one particle at a time, for tests.
template <class Real, Choice choice>
std::unique_ptr<SlamFilter> make_marginal(const FilterSetup& setup) {
  return std::make_unique<MarginalFilter<Real>>(setup, marginal_settings(setup.options, choice));
}

FilterKind marginal_kind();
FilterKind ampf_de_kind();

}  // namespace montecarta::filters
