// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/marginal/pose_kernels.hpp"

#include <array>
#include <cstddef>
#include <limits>
#include <span>

namespace montecarta::filters {

/// Whether headings are so near each other that their differences cannot wrap.
enum class Headings { near, anywhere };

/// |W (s - m)|^2 for one kernel; the target's heading is relative to the kernels' reference.
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

/// Adds to each sum what `kernels` contribute at the target, in units of the peak.
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

/// Logs of the sums where they are too small for linear numbers: each with a peak of its own taken
/// out.
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

/// Logs of linear sums; where one is so small that terms were lost, they are summed again.
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

/// The target in the kernels' terms.
template <class Real, std::size_t N>
BasicPose<Real> relative_to(const PoseKernels<N>& mixture, const BasicPose<Real>& target) {
  return {target.x, target.y, wrap(Real(target.heading - Real(mixture.reference())))};
}

/// Calls with Headings::near where neither kernels nor targets can wrap, else Headings::anywhere.
template <class Real, std::size_t N, class Call>
auto by_headings(const PoseKernels<N>& mixture, const BasicPose<Real>& relative, const Call& call) {
  const Real& h = relative.heading;
  const Real farthest = max(h, Real(-h));
  if (any(farthest + Real(mixture.half_range()) >= Real(kPi)))
    return call.template operator()<Headings::anywhere>();
  return call.template operator()<Headings::near>();
}

/// log Sum_j weights_n[j] N(target; m_j, C_j) for every n, kernel by kernel in index order.
template <class Real, std::size_t N>
std::array<Real, N> direct_log_sums(const BasicPose<Real>& target, const PoseKernels<N>& mixture) {
  const BasicPose<Real> relative = relative_to(mixture, target);
  std::array<Real, N> sums;
  sums.fill(Real(0.0));
  by_headings(mixture, relative, [&]<Headings headings>() {
    add_kernels<headings>(relative, mixture.kernels(), sums);
  });
  return logs_of(sums, relative, mixture);
}

}  // namespace montecarta::filters
