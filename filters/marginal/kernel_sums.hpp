// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/marginal/gauss_transform.hpp"
#include "filters/marginal/marginal_options.hpp"
#include "filters/population/population.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace montecarta::filters {

/// One Gaussian of a mixture over poses in a form that is quickly evaluated: its mean, and the
/// factor W with W' W = C^-1 / 2, so that N(s; m, C) is proportional to exp(-|W (s - m)|^2). Every
/// kernel has its own factor, since C rotates with the heading.
template <std::size_t N>
struct PoseKernel {
  double x, y, heading;           ///< mean; heading relative to the reference of the mixture
  double xx, yx, yy, hx, hy, hh;  ///< W, lower triangular
  std::array<double, N> height;   ///< weight times peak density, for each of the N sums
};

/// N mixtures with common kernels and different weights: Sum_j weights_n[j] N(s; m_j, C_j). The
/// sums share the exponential, which dominates the cost.
template <std::size_t N>
class PoseKernels {
 public:
  /// Makes kernels from the Gaussians of the first `weights[0].size()` particles, which must be
  /// positive definite. Throws std::runtime_error if one has no density.
  template <class Real>
  void assign(std::span<const PoseGaussian<Real>> gaussians,
              const std::array<std::span<const double>, N>& weights) {
    const std::size_t size = weights[0].size();
    kernels_.resize(size);
    log_peaks_.resize(size);
    reference_ = get(gaussians[0].mean.heading, 0);
    half_range_ = 0.0;
    for (std::size_t b = 0; b < gaussians.size(); ++b) factor(gaussians[b], b, size);
    log_peak_ = *std::max_element(log_peaks_.begin(), log_peaks_.end());
    for (std::size_t j = 0; j < size; ++j) {
      const double peak = std::exp(log_peaks_[j] - log_peak_);
      for (std::size_t n = 0; n < N; ++n) kernels_[j].height[n] = weights[n][j] * peak;
    }
  }

  std::span<const PoseKernel<N>> kernels() const { return kernels_; }
  /// Log of the density that a height of one represents.
  double log_peak() const { return log_peak_; }
  /// Reference [rad] of the headings of the kernels.
  double reference() const { return reference_; }
  /// Greatest distance [rad] of the heading of a kernel from the reference.
  double half_range() const { return half_range_; }

 private:
  static constexpr double kLogTwoPi = 1.8378770664093454836;

  template <class Real>
  void factor(const PoseGaussian<Real>& gaussian, std::size_t b, std::size_t size) {
    const Cholesky3<Real> L(gaussian.covariance);
    const Real half(std::sqrt(0.5));
    const Real xx = half / L.xx, yy = half / L.yy, hh = half / L.hh;
    const Real yx = -(L.yx * xx) / L.yy;
    const Real hy = -(L.hy * yy) / L.hh, hx = -(L.hx * xx + L.hy * yx) / L.hh;
    const Real log_peak = -log(L.xx * L.yy * L.hh) - Real(1.5 * kLogTwoPi);
    const Real heading = wrap(gaussian.mean.heading - Real(reference_));
    constexpr std::size_t lanes = kLanesOf<Real>;
    for (std::size_t l = 0; l < lanes && b * lanes + l < size; ++l) {
      PoseKernel<N>& kernel = kernels_[b * lanes + l];
      kernel = {.x = get(gaussian.mean.x, l),
                .y = get(gaussian.mean.y, l),
                .heading = get(heading, l),
                .xx = get(xx, l),
                .yx = get(yx, l),
                .yy = get(yy, l),
                .hx = get(hx, l),
                .hy = get(hy, l),
                .hh = get(hh, l),
                .height = {}};
      log_peaks_[b * lanes + l] = get(log_peak, l);
      if (!std::isfinite(get(log_peak, l)))
        throw std::runtime_error("a kernel of the mixture has no density");
      half_range_ = std::max(half_range_, std::abs(kernel.heading));
    }
  }

  std::vector<PoseKernel<N>> kernels_;
  std::vector<double> log_peaks_;  ///< scratch: logarithms of the peak densities
  double log_peak_ = 0.0;
  double reference_ = 0.0;
  double half_range_ = 0.0;
};

/// `near` means that headings are so close to each other that their differences cannot wrap.
enum class Headings { near, anywhere };

/// Squared length of W (s - m), with the heading of `target` relative to the kernels' reference.
template <Headings headings, class Real, std::size_t N>
[[gnu::always_inline]] inline Real half_squared_distance(const BasicPose<Real>& target,
                                                         const PoseKernel<N>& kernel) {
  const Real dx = target.x - Real(kernel.x), dy = target.y - Real(kernel.y);
  Real dh = target.heading - Real(kernel.heading);
  if constexpr (headings == Headings::anywhere) dh = wrap(dh);
  const Real a = Real(kernel.xx) * dx;
  const Real b = fma(Real(kernel.yx), dx, Real(kernel.yy) * dy);
  const Real c = fma(Real(kernel.hx), dx, fma(Real(kernel.hy), dy, Real(kernel.hh) * dh));
  return fma(a, a, fma(b, b, c * c));
}

/// Adds the contribution of `kernels` at the target to each sum, in units of the peak.
template <Headings headings, class Real, std::size_t N>
void add_kernels(const BasicPose<Real>& target, std::span<const PoseKernel<N>> kernels,
                 std::array<Real, N>& sums) {
  std::array<Real, N> total = sums;
  for (const PoseKernel<N>& kernel : kernels) {
    const Real density = exp(-half_squared_distance<headings>(target, kernel));
    for (std::size_t n = 0; n < N; ++n) total[n] = fma(Real(kernel.height[n]), density, total[n]);
  }
  sums = total;
}

/// Logs of sums that underflow: the largest exponent of each is factored out.
template <class Real, std::size_t N>
std::array<Real, N> log_sums_of_far_kernels(const BasicPose<Real>& target,
                                            std::span<const PoseKernel<N>> kernels) {
  std::array<Real, N> logs;
  for (std::size_t n = 0; n < N; ++n) {
    const auto exponent = [&](const PoseKernel<N>& kernel) {
      return Real(std::log(kernel.height[n])) -
             half_squared_distance<Headings::anywhere>(target, kernel);
    };
    Real peak(-std::numeric_limits<double>::max()), sum(0.0);
    for (const auto& kernel : kernels) peak = max(peak, exponent(kernel));
    for (const auto& kernel : kernels) sum += exp(exponent(kernel) - peak);
    logs[n] = peak + log(sum);
  }
  return logs;
}

/// Logs of linear sums. Sums too small for that are computed by log_sums_of_far_kernels().
template <class Real, std::size_t N>
std::array<Real, N> logs_of(const std::array<Real, N>& sums, const BasicPose<Real>& target,
                            const PoseKernels<N>& mixture) {
  constexpr double kLeast = 1e-280;
  std::array<Real, N> logs;
  bool is_far = false;
  for (std::size_t n = 0; n < N; ++n) {
    logs[n] = log(max(sums[n], Real(kLeast)));
    is_far = is_far || any(sums[n] < Real(kLeast));
  }
  if (is_far) {
    const auto far = log_sums_of_far_kernels(target, mixture.kernels());
    for (std::size_t n = 0; n < N; ++n) logs[n] = select(sums[n] < Real(kLeast), far[n], logs[n]);
  }
  for (Real& value : logs) value += Real(mixture.log_peak());
  return logs;
}

/// The target with its heading relative to the reference of the kernels.
template <class Real, std::size_t N>
BasicPose<Real> relative_to(const PoseKernels<N>& mixture, const BasicPose<Real>& target) {
  return {target.x, target.y, wrap(Real(target.heading - Real(mixture.reference())))};
}

/// log Sum_j weights_n[j] N(target; m_j, C_j) for every n, summed in the order of the kernels.
template <class Real, std::size_t N>
std::array<Real, N> direct_log_sums(const BasicPose<Real>& target, const PoseKernels<N>& mixture) {
  const BasicPose<Real> relative = relative_to(mixture, target);
  std::array<Real, N> sums;
  sums.fill(Real(0.0));
  const Real farthest = max(relative.heading, Real(-relative.heading));
  if (any(farthest + Real(mixture.half_range()) >= Real(kPi))) {
    add_kernels<Headings::anywhere>(relative, mixture.kernels(), sums);
  } else {
    add_kernels<Headings::near>(relative, mixture.kernels(), sums);
  }
  return logs_of(sums, relative, mixture);
}

/// Mixtures summed by the improved fast Gauss transform (Havangi, appendix; EQUATIONS 13). It uses
/// one covariance for all kernels, that of the kernel at the mean heading, so it is only exact if
/// all headings agree. A sum that is not far above the error is summed directly.
template <std::size_t N>
class IfgtSums {
 public:
  /// `first` is the kernel of the first particle; all others must be rotated copies of it. Returns
  /// false if a transform is not faster.
  [[nodiscard]] bool build(const PoseKernels<N>& mixture, const PoseGaussian<double>& first,
                           double tolerance) {
    if (mixture.half_range() >= 0.5 * kPi) return false;
    const auto kernels = mixture.kernels();
    common_ = common_kernel(mixture, first);
    sites_.clear(), charges_.clear();
    least_.fill(0.0);
    for (const PoseKernel<N>& kernel : kernels) {
      sites_.push_back(whitened(BasicPose<double>{kernel.x, kernel.y, kernel.heading}));
      charges_.push_back(kernel.height);
      for (std::size_t n = 0; n < N; ++n) least_[n] += 1e3 * tolerance * kernel.height[n];
    }
    return transform_.build(sites_, charges_, tolerance);
  }

  template <class Real>
  std::array<Real, N> log_sums(const BasicPose<Real>& target, const PoseKernels<N>& mixture,
                               std::vector<Real>& scratch) const {
    const BasicPose<Real> relative = relative_to(mixture, target);
    std::array<Real, N> sums = transform_(whitened(relative), scratch);
    auto is_safe = sums[0] >= Real(least_[0]);
    for (std::size_t n = 1; n < N; ++n) is_safe = is_safe && sums[n] >= Real(least_[n]);
    std::array<Real, N> logs;
    for (std::size_t n = 0; n < N; ++n)
      logs[n] = log(select(is_safe, sums[n], Real(1.0))) + Real(mixture.log_peak());
    if (!any(!is_safe)) return logs;
    const auto direct = direct_log_sums(target, mixture);
    for (std::size_t n = 0; n < N; ++n) logs[n] = select(is_safe, logs[n], direct[n]);
    return logs;
  }

 private:
  static PoseKernel<1> common_kernel(const PoseKernels<N>& mixture,
                                     const PoseGaussian<double>& first) {
    double turn = 0.0, total = 0.0;
    for (const PoseKernel<N>& kernel : mixture.kernels()) {
      turn += kernel.height[0] * (kernel.heading - mixture.kernels()[0].heading);
      total += kernel.height[0];
    }
    PoseGaussian<double> mean = first;
    mean.covariance = turned(first.covariance, direction_of(turn / total));
    const double one = 1.0;
    PoseKernels<1> common;
    common.assign(std::span<const PoseGaussian<double>>(&mean, 1), {std::span(&one, 1)});
    return common.kernels()[0];
  }

  /// W (pose - mean of the common kernel), with headings relative to the reference of the mixture.
  template <class Real>
  std::array<Real, 3> whitened(const BasicPose<Real>& pose) const {
    const Real dx = pose.x - Real(common_.x), dy = pose.y - Real(common_.y);
    const Real& h = pose.heading;
    return {Real(common_.xx) * dx, Real(common_.yx) * dx + Real(common_.yy) * dy,
            Real(common_.hx) * dx + Real(common_.hy) * dy + Real(common_.hh) * h};
  }

  PoseKernel<1> common_{};
  std::vector<std::array<double, 3>> sites_;
  std::vector<std::array<double, N>> charges_;
  std::array<double, N> least_{};  ///< {sum} least sum that is accurate enough
  GaussTransform<3, N> transform_;
};

/// log Sum_j weights_n[j] N(target; gaussian_j) for blocks of targets and every n (EQUATIONS 13),
/// by the given method. The transform is offered because the paper has it. Direct sums are faster,
/// and an absolute error is unsuitable for weights (tests/filters/marginal/marginal_benchmark.cpp).
template <class Real, std::size_t N>
class KernelSummation {
 public:
  KernelSummation(KernelSums method, double tolerance) : asked_(method), tolerance_(tolerance) {}

  /// Prepares the method; direct sums are used if the transform is not faster.
  void assign(std::span<const PoseGaussian<Real>> gaussians,
              const std::array<std::span<const double>, N>& weights) {
    kernels_.assign(gaussians, weights);
    used_ = asked_;
    if (used_ == KernelSums::ifgt && !ifgt_.build(kernels_, of_lane(gaussians[0], 0), tolerance_)) {
      used_ = KernelSums::direct;
    }
  }
  KernelSums used() const { return used_; }

  /// Writes logs[b] for targets[b]. Blocks are independent of each other.
  void sum(const StepContext& context, std::span<const BasicPose<Real>> targets,
           std::span<std::array<Real, N>> logs) {
    constexpr std::size_t kPairsPerTask = 1U << 14;  // a task takes about 20 us
    const std::size_t pairs_per_block = kLanesOf<Real> * kernels_.kernels().size();
    const std::size_t per_task = std::max<std::size_t>(1, kPairsPerTask / pairs_per_block);
    const BlockTasks<Real> tasks(targets.size(), per_task);
    scratch_.resize(std::max(scratch_.size(), tasks.count()));
    tasks.run(context, [&](std::size_t task, std::size_t b) {
      logs[b] = used_ == KernelSums::ifgt ? ifgt_.log_sums(targets[b], kernels_, scratch_[task])
                                          : direct_log_sums(targets[b], kernels_);
    });
  }

 private:
  KernelSums asked_, used_ = KernelSums::direct;
  double tolerance_;
  PoseKernels<N> kernels_;
  IfgtSums<N> ifgt_;
  std::vector<std::vector<Real>> scratch_;  ///< {task} scratch of the transform
};

/// The ratio of the weights of a marginal filter to the likelihood: Sum_j w_j N(s_i; prior_j) /
/// Sum_j lambda_j N(s_i; proposal_j) (EQUATIONS (12.4)).
template <class Real>
class KernelRatios {
 public:
  using Gaussians = std::vector<PoseGaussian<Real>>;

  /// With prior kernels both sums differ only in the weights. If the weights are equal, too, the
  /// ratio is one for any target, and nothing is summed. Kernels refined by a scan have different
  /// covariances, for which the transform cannot be used.
  explicit KernelRatios(const MarginalSettings& settings)
      : is_shared_(settings.kernel == Kernel::prior),
        is_one_(is_shared_ && settings.choice == Choice::by_weight),
        shared_(settings.kernel_sums, settings.kernel_tolerance),
        numerator_(KernelSums::direct, settings.kernel_tolerance),
        denominator_(KernelSums::direct, settings.kernel_tolerance),
        logs_(blocks_for<Real>(settings.particles)),
        log_numerators_(logs_.size()),
        log_denominators_(logs_.size()) {}

  /// With prior kernels, `proposal` must be `priors`.
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
  bool is_shared_, is_one_;
  KernelSummation<Real, 2> shared_;
  KernelSummation<Real, 1> numerator_, denominator_;
  std::vector<std::array<Real, 2>> logs_;
  std::vector<std::array<Real, 1>> log_numerators_, log_denominators_;
};

}  // namespace montecarta::filters
