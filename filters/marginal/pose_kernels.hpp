// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/moments/gaussians.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace montecarta::filters {

/// One Gaussian of a mixture over poses, ready to be evaluated anywhere: its mean, and the factor W
/// with W' W = C^-1 / 2, so that N(s; m, C) is proportional to exp(-|W (s - m)|^2). Every kernel
/// has a factor of its own: C turns with the heading.
template <std::size_t N>
struct PoseKernel {
  double x, y, heading;           ///< mean; heading relative to the mixture's reference
  double xx, yx, yy, hx, hy, hh;  ///< W, lower triangular
  std::array<double, N> height;   ///< weights times the peak of the density, of the N sums
};

/// N mixtures with common kernels and weights of their own: Sum_j weights_n[j] N(s; m_j, C_j). The
/// sums share the exponential, which is what they cost.
template <std::size_t N>
class PoseKernels {
 public:
  /// Kernels from the first `weights[0].size()` particles' Gaussians, which must be positive
  /// definite. Throws where one has no density.
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
  /// log of what a height of one stands for.
  double log_peak() const { return log_peak_; }
  /// Headings are kept relative to this one [rad].
  double reference() const { return reference_; }
  /// No kernel's heading is farther from the reference [rad].
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
  std::vector<double> log_peaks_;  ///< scratch
  double log_peak_ = 0.0;
  double reference_ = 0.0;
  double half_range_ = 0.0;
};

}  // namespace montecarta::filters
