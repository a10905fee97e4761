// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/marginal/direct_sums.hpp"
#include "filters/marginal/kd_order.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace montecarta::filters {

/// Kernels in kd order, cut into leaves, and for each leaf what it can contribute at most: sums
/// over near leaves only, with a relative error that is guaranteed for every target and sum.
template <std::size_t N>
class KernelTree {
 public:
  void build(const PoseKernels<N>& mixture) {
    mixture_ = &mixture;
    const auto kernels = mixture.kernels();
    points_.resize(kernels.size());
    for (std::size_t j = 0; j < kernels.size(); ++j)
      points_[j] = whitened(kernels[0], kernels[j].x, kernels[j].y, kernels[j].heading);
    extent_ = extent_of(points_);
    kd_order(points_, kLeaf, order_);
    sorted_.resize(kernels.size());
    for (std::size_t j = 0; j < kernels.size(); ++j) sorted_[j] = kernels[order_[j]];
    leaves_.clear();
    for (std::size_t begin = 0; begin < sorted_.size(); begin += kLeaf)
      leaves_.push_back(leaf_of(
          std::span(sorted_).subspan(begin).first(std::min(kLeaf, sorted_.size() - begin))));
  }

  /// As direct_log_sums(), but for a relative error of each sum of at most `tolerance`.
  template <class Real>
  std::array<Real, N> log_sums(const BasicPose<Real>& target, double tolerance) const {
    const BasicPose<Real> relative = relative_to(*mixture_, target);
    std::array<Real, N> sums;
    sums.fill(Real(0.0));
    by_headings(*mixture_, relative, [&]<Headings headings>() {
      for (const Leaf& leaf : leaves_) {
        if (any(leaf.distance(relative) < Real(kNear)))
          add_kernels<headings>(relative, leaf.kernels, sums);
      }
      const double share = tolerance / static_cast<double>(leaves_.size());
      for (const Leaf& leaf : leaves_) {
        const Real distance = leaf.distance(relative);
        if (!any(distance < Real(kNear)) && leaf.matters(distance, sums, share))
          add_kernels<headings>(relative, leaf.kernels, sums);
      }
    });
    return logs_of(sums, relative, *mixture_);
  }

  /// How far the means lie apart [sigmas of a kernel].
  double extent() const { return extent_; }

  /// A pose in the terms in which the kernels were put in order.
  Point3 whitened_by_first(const Pose& pose) const {
    const Pose relative = relative_to(*mixture_, pose);
    return whitened(mixture_->kernels()[0], relative.x, relative.y, relative.heading);
  }

 private:
  static constexpr std::size_t kLeaf = 32;
  static constexpr double kNear = 1.0;  ///< leaves this near [half squared sigmas] come first

  /// W (pose - mean) of a kernel; headings relative to the mixture's reference.
  template <class Real>
  static std::array<Real, 3> whitened(const PoseKernel<N>& by, const Real& x, const Real& y,
                                      const Real& heading) {
    const Real dx = x - Real(by.x), dy = y - Real(by.y),
               dh = wrap(Real(heading - Real(by.heading)));
    return {Real(by.xx) * dx, Real(by.yx) * dx + Real(by.yy) * dy,
            Real(by.hx) * dx + Real(by.hy) * dy + Real(by.hh) * dh};
  }

  struct Leaf {
    std::span<const PoseKernel<N>> kernels;
    PoseKernel<N> centre;            ///< by which the leaf is whitened
    Point3 low, high;                ///< the means, whitened
    double least_sharpness = 1.0;    ///< every kernel's |W v|^2 is at least this times the centre's
    double half_turn = 0.0;          ///< farther from the centre's heading differences might wrap
    std::array<double, N> height{};  ///< sums

    /// A lower bound of |W (target - mean)|^2 over all kernels.
    template <class Real>
    Real distance(const BasicPose<Real>& target) const {
      const auto y = whitened(centre, target.x, target.y, target.heading);
      Real squared(0.0);
      for (std::size_t d = 0; d < 3; ++d) {
        const Real out = max(max(Real(low[d]) - y[d], y[d] - Real(high[d])), Real(0.0));
        squared += out * out;
      }
      const Real turn = wrap(Real(target.heading - Real(centre.heading)));
      return select(max(turn, Real(-turn)) < Real(half_turn), Real(least_sharpness) * squared,
                    Real(0.0));
    }
    /// Whether it may contribute more than `share` of a sum.
    template <class Real>
    bool matters(const Real& distance, const std::array<Real, N>& sums, double share) const {
      const Real density = exp(-distance);
      bool found = false;
      for (std::size_t n = 0; n < N; ++n)
        found = found || any(Real(height[n]) * density > Real(share) * sums[n]);
      return found;
    }
  };

  static Leaf leaf_of(std::span<const PoseKernel<N>> kernels) {
    Leaf leaf{.kernels = kernels, .centre = kernels[kernels.size() / 2], .low = {}, .high = {}};
    leaf.low = leaf.high = whitened(leaf.centre, kernels[0].x, kernels[0].y, kernels[0].heading);
    double most_heading = 0.0, bluntest = 1.0;
    for (const PoseKernel<N>& kernel : kernels) {
      const Point3 y = whitened(leaf.centre, kernel.x, kernel.y, kernel.heading);
      for (std::size_t d = 0; d < 3; ++d) {
        leaf.low[d] = std::min(leaf.low[d], y[d]);
        leaf.high[d] = std::max(leaf.high[d], y[d]);
      }
      most_heading = std::max(most_heading, std::abs(wrap(kernel.heading - leaf.centre.heading)));
      bluntest = std::max(bluntest, bluntness(leaf.centre, kernel));
      for (std::size_t n = 0; n < N; ++n) leaf.height[n] += kernel.height[n];
    }
    leaf.least_sharpness = 1.0 / bluntest;
    leaf.half_turn = kPi - most_heading;
    return leaf;
  }

  /// An upper bound (Gershgorin) of the greatest eigenvalue of X X' with X = W_centre W^-1.
  static double bluntness(const PoseKernel<N>& centre, const PoseKernel<N>& kernel) {
    const double hh = centre.hh / kernel.hh;
    const double hy = (centre.hy - hh * kernel.hy) / kernel.yy;
    const double yy = centre.yy / kernel.yy;
    const double hx = (centre.hx - hy * kernel.yx - hh * kernel.hx) / kernel.xx;
    const double yx = (centre.yx - yy * kernel.yx) / kernel.xx;
    const double xx = centre.xx / kernel.xx;
    const double a = std::abs(xx * yx), b = std::abs(xx * hx), c = std::abs(yx * hx + yy * hy);
    return std::max(
        {xx * xx + a + b, yx * yx + yy * yy + a + c, hx * hx + hy * hy + hh * hh + b + c});
  }

  static double extent_of(std::span<const Point3> points) {
    double most = 0.0;
    for (std::size_t d = 0; d < 3; ++d) {
      const auto [low, high] =
          std::minmax_element(points.begin(), points.end(),
                              [d](const Point3& a, const Point3& b) { return a[d] < b[d]; });
      most = std::max(most, (*high)[d] - (*low)[d]);
    }
    return most * std::sqrt(2.0);  // W whitens to a variance of one half
  }

  const PoseKernels<N>* mixture_ = nullptr;
  double extent_ = 0.0;
  std::vector<Point3> points_;
  std::vector<std::uint32_t> order_;
  std::vector<PoseKernel<N>> sorted_;
  std::vector<Leaf> leaves_;
};

}  // namespace montecarta::filters
