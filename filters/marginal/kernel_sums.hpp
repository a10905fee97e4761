// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/step_context.hpp"
#include "engine/particles/blocks.hpp"
#include "engine/particles/weights.hpp"
#include "filters/marginal/direct_sums.hpp"
#include "filters/marginal/ifgt_sums.hpp"
#include "filters/marginal/marginal_options.hpp"
#include "filters/marginal/pose_kernels.hpp"
#include "filters/population/cloud_moments.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace montecarta::filters {

/// log Sum_j weights_n[j] N(target; gaussian_j) for blocks of targets and every n (EQUATIONS 13),
/// by the method asked for. The transform is there because the paper has it: direct sums are
/// faster, and its error is of the wrong kind for weights
/// (tests/filters/marginal/kernel_sums_benchmark.cpp).
template <class Real, std::size_t N>
class KernelSummation {
 public:
  KernelSummation(KernelSums method, double tolerance) : asked_(method), tolerance_(tolerance) {}

  /// Prepares the method; where the transform does not pay the direct one is used.
  void assign(std::span<const PoseGaussian<Real>> gaussians,
              const std::array<std::span<const double>, N>& weights) {
    kernels_.assign(gaussians, weights);
    used_ = asked_;
    if (used_ == KernelSums::ifgt && !ifgt_.build(kernels_, of_lane(gaussians[0], 0), tolerance_)) {
      used_ = KernelSums::direct;
    }
  }
  KernelSums used() const { return used_; }

  /// logs[b] of targets[b]. Blocks are independent of each other.
  void sum(const StepContext& context, std::span<const BasicPose<Real>> targets,
           std::span<std::array<Real, N>> logs) {
    over_blocks(context, targets.size(),
                [&](std::size_t b, auto& scratch) { logs[b] = at(targets[b], scratch); });
  }

 private:
  static constexpr std::size_t kLanes = kLanesOf<Real>;

  std::array<Real, N> at(const BasicPose<Real>& target, std::vector<Real>& scratch) const {
    return used_ == KernelSums::ifgt ? ifgt_.log_sums(target, kernels_, scratch)
                                     : direct_log_sums(target, kernels_);
  }

  template <class Body>
  void over_blocks(const StepContext& context, std::size_t blocks, const Body& body) {
    constexpr std::size_t kPairsPerTask = 1U << 14;  // some 20 us
    const std::size_t pairs_per_block = kLanes * kernels_.kernels().size();
    const std::size_t per_task = std::max<std::size_t>(1, kPairsPerTask / pairs_per_block);
    const BlockTasks<Real> tasks(blocks, per_task);
    scratch_.resize(std::max(scratch_.size(), tasks.count()));
    tasks.run(context, [&](std::size_t task, std::size_t b) { body(b, scratch_[task]); });
  }

  KernelSums asked_, used_ = KernelSums::direct;
  double tolerance_;
  PoseKernels<N> kernels_;
  IfgtSums<N> ifgt_;
  std::vector<std::vector<Real>> scratch_;  ///< of each task, for the transform
};

/// The factor by which the weights of a marginal filter differ from the likelihood: Sum_j w_j
/// N(s_i; prior_j) / Sum_j lambda_j N(s_i; proposal_j) (EQUATIONS (12.4)).
template <class Real>
class KernelRatios {
 public:
  using Gaussians = std::vector<PoseGaussian<Real>>;

  /// With prior kernels the sums share everything but the weights; if those are equal, too, the
  /// ratio is one wherever the targets are, and nothing is summed.
  explicit KernelRatios(const MarginalSettings& settings)
      : is_shared_(settings.kernel == Kernel::prior),
        is_one_(is_shared_ && settings.choice == Choice::by_weight),
        shared_(settings.kernel_sums, settings.kernel_tolerance),
        numerator_(without_transform(settings.kernel_sums), settings.kernel_tolerance),
        denominator_(without_transform(settings.kernel_sums), settings.kernel_tolerance),
        logs_(blocks_for<Real>(settings.particles)),
        log_numerators_(logs_.size()),
        log_denominators_(logs_.size()) {}

  /// `proposal` is `priors` itself with prior kernels.
  void assign(const Gaussians& priors, const Gaussians& proposal, const Weights<Real>& w,
              const Weights<Real>& lambda) {
    if (is_one_) return;
    if (is_shared_) {
      shared_.assign(priors, {w.linear_scalars(), lambda.linear_scalars()});
    } else {
      numerator_.assign(priors, {w.linear_scalars()});
      denominator_.assign(proposal, {lambda.linear_scalars()});
    }
  }

  /// Multiplies the weights by the ratios at `poses`.
  void multiply(const StepContext& context, const std::vector<BasicPose<Real>>& poses,
                Weights<Real>& weights) {
    if (is_one_) return;
    if (is_shared_) {
      shared_.sum(context, poses, logs_);
      for (std::size_t b = 0; b < logs_.size(); ++b) weights.multiply(b, logs_[b][0] - logs_[b][1]);
    } else {
      numerator_.sum(context, poses, log_numerators_);
      denominator_.sum(context, poses, log_denominators_);
      for (std::size_t b = 0; b < logs_.size(); ++b)
        weights.multiply(b, log_numerators_[b][0] - log_denominators_[b][0]);
    }
  }

 private:
  /// Kernels refined by a scan have covariances of their own, which the transform cannot take.
  static KernelSums without_transform(KernelSums method) {
    return method == KernelSums::ifgt ? KernelSums::direct : method;
  }

  bool is_shared_, is_one_;
  KernelSummation<Real, 2> shared_;
  KernelSummation<Real, 1> numerator_, denominator_;
  std::vector<std::array<Real, 2>> logs_;
  std::vector<std::array<Real, 1>> log_numerators_, log_denominators_;
};

}  // namespace montecarta::filters
