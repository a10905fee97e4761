// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/plain/map_learning.hpp"
#include "filters/plain/particle.hpp"
#include "filters/plain/resampling.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace montecarta::filters::plain {

/// Marginal and auxiliary marginal particle filter with one map for all particles (EQUATIONS 12;
/// Martinez-Cantin et al. 2007; Havangi et al. 2013, (10) to (18)).
class Marginal final : public SlamFilter {
 public:
  Marginal(const FilterSetup& setup, Choice choice)
      : setup_(setup),
        settings_(map_settings(setup.options)),
        is_auxiliary_(choice == Choice::by_likelihood),
        is_posterior_(setup.options.choice("kernel") == "posterior"),
        learning_(settings_, setup.belief),
        R_(observation_noise(setup.belief)) {
    const double xy = std::max(setup.options.number("kernel_floor_xy"), 1e-5);
    const double heading = std::max(setup.options.number("kernel_floor_heading"), 1e-6);
    floor_ = Vector<3>(xy, xy, heading).cwiseAbs2().asDiagonal();
  }

  void start(const Pose& start) override {
    start_from(StepContext::before_all_steps(), {.pose = {start}});
  }
  /// Particles are drawn from the prior of the pose. They share the known map.
  void start_from(const StepContext& context, const Prior& prior) override {
    const Vector<3> mean = to_vector(prior.pose.mean);
    const Matrix<3> root = root_along(mean(2), prior.pose.covariance);
    kernels_.resize(setup_.options.integer("particles"));
    const double log_even = -std::log(static_cast<double>(kernels_.size()));
    for (std::uint32_t i = 0; i < kernels_.size(); ++i) {
      kernels_[i] = {drawn_from(mean, root, context.stream(Draw::start_sample, i)),
                     Matrix<3>::Zero(), log_even};
    }
    forget_ancestors();
    map_ = known_map(prior.map);
    report_ = {};
  }

  void predict(const StepContext& /*context*/, const Control& control, double duration) override {
    for (Kernel& kernel : kernels_)
      move_linearised(kernel.mean, kernel.covariance, control, duration, setup_.belief);
  }

  void update(const StepContext& context, Scan scan) override {
    forget_ancestors();
    report_ = {.ess = effective_size(kernels_)};
    associate(scan);
    const auto n_ignored = std::ranges::count(pairings_, PairingKind::ignored, &Pairing::kind);
    if (n_ignored < std::ssize(pairings_)) {  // otherwise the kernels keep growing
      draw_and_weigh(context, scan);
      for (const Pairing& one : pairings_) {
        if (one.kind != PairingKind::matched) report_.log_likelihood += log_unmatched(setup_);
      }
      learn_map(context, scan);
    }
    report_.map_size = static_cast<double>(map_.size());
  }

  PoseEstimate estimate() const override { return {mixture(Matrix<3>::Zero()), std::nullopt}; }
  const ScanReport& report() const override { return report_; }
  void particles(const ParticleColumns& columns) const override {
    for (std::size_t i = 0; i < kernels_.size(); ++i)
      write_particle(columns, i, kernels_[i].mean, kernels_[i].log_weight, ancestors_[i]);
  }
  void map(std::span<std::optional<LandmarkEstimate>> landmarks) const override {
    for (std::size_t k = 0; k < landmarks.size(); ++k) {
      landmarks[k].reset();
      if (const auto slot = slot_of(k, identities_of(map_), setup_.association.kind))
        landmarks[k] = {map_[*slot].mean, map_[*slot].covariance};
    }
  }

  const std::vector<Pairing>& pairings() const { return pairings_; }  ///< of the last scan
  const MapLearning& learning() const { return learning_; }

 private:
  /// p(s | s_j) = N(mean, covariance + floor) with its weight (EQUATIONS (12.1)). After a draw the
  /// covariance is zero.
  struct Kernel {
    Vector<3> mean;
    Matrix<3> covariance;
    double log_weight;
  };

  void forget_ancestors() {
    ancestors_.resize(kernels_.size());
    std::iota(ancestors_.begin(), ancestors_.end(), 0U);
  }

  PoseMoments mixture(const Matrix<3>& floor) const {
    return mixture_moments(
        kernels_, [](const Kernel& kernel) { return kernel.mean; },
        [&](const Kernel& kernel) -> Matrix<3> { return kernel.covariance + floor; });
  }

  /// Associates once for all, from the mean of the kernels (EQUATIONS 17). A one-step map is a
  /// parameter of the likelihood and has no covariance there.
  void associate(Scan scan) {
    believed_ = map_;
    if (settings_.mode != MapMode::recursive) {
      for (Landmark& landmark : believed_) landmark.covariance.setZero();
    }
    const PoseMoments predicted = mixture(floor_);
    pairings_ = pair(scan, believed_, to_vector(predicted.mean), predicted.covariance, setup_);
    report_.association = association_counts(scan, pairings_, identities_of(map_));
  }

  /// Calls visit(landmark, k) for each matched detection k.
  template <class Visit>
  void for_each_match(const Visit& visit) const {
    for (std::size_t k = 0; k < pairings_.size(); ++k) {
      if (pairings_[k].kind == PairingKind::matched) visit(believed_[pairings_[k].landmark], k);
    }
  }

  void draw_and_weigh(const StepContext& context, Scan scan) {
    std::vector<Kernel> prior = kernels_;
    for (Kernel& kernel : prior) kernel.covariance += floor_;
    const std::vector<Kernel> proposal = chosen(prior, scan);
    ancestors_ = parents_by(Resampling::stratified, weights_of(proposal), context);
    const bool has_one_ratio = !is_auxiliary_ && !is_posterior_;  // that of a mixture to itself
    for (std::uint32_t i = 0; i < kernels_.size(); ++i) {         // EQUATIONS (12.3), (12.4)
      const Kernel& parent = proposal[ancestors_[i]];
      const Vector<3> pose = drawn_from(parent.mean, root_along(parent.mean(2), parent.covariance),
                                        context.stream(Draw::kernel_sample, i));
      kernels_[i] = {pose, Matrix<3>::Zero(), log_likelihood(pose, scan)};
      if (!has_one_ratio) kernels_[i].log_weight += log_sum(prior, pose) - log_sum(proposal, pose);
    }
    const double M = static_cast<double>(kernels_.size());
    report_.log_likelihood = normalise(kernels_) - std::log(M);
    report_.ess = effective_size(kernels_);
    report_.resampled = true;
  }

  /// The kernels that poses are drawn from, with the weights lambda of EQUATIONS (12.2).
  std::vector<Kernel> chosen(std::vector<Kernel> kernels, Scan scan) {
    std::vector<MixtureInnovation> sums(scan.size());
    for (Kernel& kernel : kernels) {
      const double log_explained = explain(kernel, scan, std::exp(kernel.log_weight), sums);
      if (is_auxiliary_) kernel.log_weight += log_explained;
    }
    if (is_auxiliary_) normalise(kernels);
    for (const MixtureInnovation& one : sums) one.add_to(report_);
    return kernels;
  }

  /// log p(z | kernel) at its mean. With kernel=posterior the detections also update the kernel
  /// (EQUATIONS (6.1)), and this is (6.2). Adds each innovation to its mixture with this weight.
  double explain(Kernel& kernel, Scan scan, double weight,
                 std::vector<MixtureInnovation>& sums) const {
    Vector<3>& x = kernel.mean;
    Matrix<3>& P = kernel.covariance;
    double log_explained = 0.0;
    for_each_match([&](const Landmark& landmark, std::size_t k) {
      const auto v = innovation_at(x, landmark, scan[k], R_);
      if (!v) return;
      const Matrix<2> S = v->Hx * P * v->Hx.transpose() + v->Sf;
      sums[k].add(weight, {v->nu, S});
      log_explained += log_gaussian<2>(v->nu, is_posterior_ ? S : v->Sf);
      if (!is_posterior_) return;
      const Matrix<3, 2> K = gain<3, 2>(P * v->Hx.transpose(), S);
      x += K * v->nu;
      P -= (K * S * K.transpose()).eval();
    });
    return log_explained;
  }

  /// log p(z | pose).
  double log_likelihood(const Vector<3>& pose, Scan scan) {
    double sum = 0.0;
    for_each_match([&](const Landmark& landmark, std::size_t k) {
      const auto v = innovation_at(pose, landmark, scan[k], R_);
      if (v) sum += log_gaussian<2>(v->nu, v->Sf);
      if (!v) ++report_.numerical_faults;
    });
    return sum;
  }

  /// The logarithm of sum_j w_j N(pose - mean_j; covariance_j).
  static double log_sum(const std::vector<Kernel>& kernels, const Vector<3>& pose) {
    std::vector<double> terms;
    for (const auto& [mean, covariance, log_weight] : kernels) {
      const Vector<3> e = boxminus(as_pose(pose), as_pose(mean));
      terms.push_back(log_weight + log_gaussian<3>(e, covariance));
    }
    return log_sum_exp(terms);
  }

  /// Updates the landmarks that were observed again, then initialises new ones (EQUATIONS 14).
  void learn_map(const StepContext& context, Scan scan) {
    WeightedPoses cloud{.pose = {}, .weight = weights_of(kernels_)};
    for (const Kernel& kernel : kernels_) cloud.pose.push_back(kernel.mean);
    const Pose mean = mixture(Matrix<3>::Zero()).mean;
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (pairings_[k].kind != PairingKind::matched) continue;
      const std::uint32_t slot = pairings_[k].landmark;
      learning_.learn(context.identity(Draw::evolution, slot), mean.heading, cloud, scan[k],
                      map_[slot]);
    }
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (pairings_[k].kind != PairingKind::fresh) continue;
      map_.push_back(learning_.initialised(cloud, mean, scan[k]));
      map_.back().identity = scan[k].identity;
    }
    refuse_large_map(map_.size(), setup_.association);
  }

  FilterSetup setup_;
  MapSettings settings_;
  bool is_auxiliary_, is_posterior_;
  MapLearning learning_;
  Matrix<2> R_;
  Matrix<3> floor_;
  std::vector<Kernel> kernels_;
  std::vector<std::uint32_t> ancestors_;
  Map map_, believed_;
  std::vector<Pairing> pairings_;
  ScanReport report_;
};

}  // namespace montecarta::filters::plain
