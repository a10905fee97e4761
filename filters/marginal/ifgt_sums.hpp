// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/marginal/direct_sums.hpp"
#include "filters/marginal/gauss_transform.hpp"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace montecarta::filters {

/// Mixtures summed by the improved fast Gauss transform (Havangi, appendix; EQUATIONS 13). It takes
/// one covariance for all kernels, that of the kernel at the mean heading: exact only if all
/// headings agree. Where a sum is not far above the error it is summed directly.
template <std::size_t N>
class IfgtSums {
 public:
  /// `first` is the first particle's kernel, of which all others are turned copies. False where a
  /// transform does not pay.
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

  /// W (pose - the common kernel's place), headings relative to the mixture's reference.
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
  std::array<double, N> least_{};  ///< sums below this are not to be trusted
  GaussTransform<3, N> transform_;
};

}  // namespace montecarta::filters
