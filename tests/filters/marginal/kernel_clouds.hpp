// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/random/stream.hpp"
#include "filters/moments/motion_increment.hpp"

#include <cstdint>
#include <vector>

namespace montecarta::filters {

/// Prior kernels of a cloud of poses after eight steps, and targets drawn near them.
template <class Real>
struct KernelCloud {
  std::vector<PoseGaussian<Real>> kernels;
  std::vector<BasicPose<Real>> targets;
  std::vector<double> w, lambda;

  /// `width`: of the cloud, in standard deviations of a kernel. `floor` [m], a tenth of it [rad].
  KernelCloud(std::size_t n, double width, double heading, double floor, std::uint32_t seed = 1)
      : kernels((n + kLanesOf<Real> - 1) / kLanesOf<Real>), targets(kernels.size()), w(n) {
    MotionIncrement motion;
    for (int k = 0; k < 8; ++k)
      motion.advance({3.0, 0.1}, 0.025, {.control = {.sigma = {0.2, 0.035}}});
    RngStream draw({seed, 0, 0, 0, Draw::test});
    const double across = width * 0.02;  // [m]
    double sum_w = 0.0, sum_lambda = 0.0;
    lambda = w;
    for (std::size_t i = 0; i < kernels.size() * kLanesOf<Real>; ++i) {
      const Pose at{100.0 + across * draw.normal(), across * draw.normal(),
                    wrap(heading + 0.05 * across * draw.normal())};
      PoseGaussian<double> kernel = motion.from(at);
      kernel.covariance.xx += floor * floor, kernel.covariance.yy += floor * floor;
      kernel.covariance.hh += 0.01 * floor * floor;
      put(i, kernel, draw);
      if (i >= n) continue;
      sum_w += w[i] = draw.uniform();
      sum_lambda += lambda[i] = w[i] * draw.uniform() * draw.uniform();
    }
    for (std::size_t i = 0; i < n; ++i) w[i] /= sum_w, lambda[i] /= sum_lambda;
  }

 private:
  void put(std::size_t i, const PoseGaussian<double>& kernel, RngStream& draw) {
    const std::size_t b = i / kLanesOf<Real>, lane = i % kLanesOf<Real>;
    const double* from = &kernel.mean.x;
    double* to = reinterpret_cast<double*>(&kernels[b]);
    for (std::size_t f = 0; f < 9; ++f) to[f * kLanesOf<Real> + lane] = from[f];
    const Cholesky3<double> L(kernel.covariance);
    const double e0 = draw.normal(), e1 = draw.normal(), e2 = draw.normal();
    set(targets[b].x, lane, kernel.mean.x + L.xx * e0);
    set(targets[b].y, lane, kernel.mean.y + L.yx * e0 + L.yy * e1);
    set(targets[b].heading, lane, wrap(kernel.mean.heading + L.hx * e0 + L.hy * e1 + L.hh * e2));
  }
};

}  // namespace montecarta::filters
