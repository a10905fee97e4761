// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "engine/particles/weights.hpp"
#include "filters/moments/gaussians.hpp"
#include "filters/moments/motion_increment.hpp"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace montecarta::filters {

/// Sum over the particles of weight times term(block), lane by lane and then in lane order.
template <class Real, std::size_t N, class Terms>
std::array<double, N> weighted_sums(const Weights<Real>& weights, const Terms& terms) {
  std::array<Real, N> lanes;
  lanes.fill(Real(0.0));
  const std::vector<Real>& w = weights.linear();
  for (std::size_t b = 0; b < w.size(); ++b) {
    const std::array<Real, N> values = terms(b);
    const auto counts = w[b] > Real(0.0);  // what a dead lane holds reaches no sum
    for (std::size_t k = 0; k < N; ++k) lanes[k] += select(counts, w[b] * values[k], Real(0.0));
  }
  std::array<double, N> sums{};
  for (std::size_t k = 0; k < N; ++k) {
    for (std::size_t lane = 0; lane < kLanesOf<Real>; ++lane) sums[k] += get(lanes[k], lane);
  }
  return sums;
}

/// The pose of particle i out of a column of structs that hold a pose; `pose_of(block)`.
template <class Real, class PoseOf>
Pose pose_of_particle(const PoseOf& pose_of, std::size_t i) {
  const BasicPose<Real> block = pose_of(i / kLanesOf<Real>);
  const std::size_t lane = i % kLanesOf<Real>;
  return {get(block.x, lane), get(block.y, lane), get(block.heading, lane)};
}

/// Weighted mean of poses: headings as differences from the heaviest particle's (EQUATIONS 19).
template <class Real, class PoseOf>
Pose weighted_mean(const Weights<Real>& weights, const PoseOf& pose_of) {
  const Pose reference = pose_of_particle<Real>(pose_of, weights.heaviest());
  const auto sums = weighted_sums<Real, 3>(weights, [&](std::size_t b) {
    const BasicPose<Real> p = pose_of(b);
    return std::array<Real, 3>{p.x - reference.x, p.y - reference.y,
                               wrap(p.heading - reference.heading)};
  });
  return {reference.x + sums[0], reference.y + sums[1], wrap(reference.heading + sums[2])};
}

/// Mean and covariance of a mixture of Gaussians (EQUATIONS 19); `gaussian_of(block)`.
template <class Real, class GaussianOf>
PoseMoments mixture_of(const Weights<Real>& weights, const GaussianOf& gaussian_of) {
  const Pose mean =
      weighted_mean<Real>(weights, [&](std::size_t b) { return gaussian_of(b).mean; });
  const auto C = weighted_sums<Real, 6>(weights, [&](std::size_t b) {
    const auto& [m, P] = gaussian_of(b);
    const Real x = m.x - mean.x, y = m.y - mean.y, h = wrap(m.heading - mean.heading);
    return std::array<Real, 6>{P.xx + x * x, P.xy + x * y, P.yy + y * y,
                               P.xh + x * h, P.yh + y * h, P.hh + h * h};
  });
  return {mean, symmetric({C[0], C[1], C[2], C[3], C[4], C[5]})};
}
template <class Real>
PoseMoments mixture_of(const Weights<Real>& weights,
                       const std::vector<PoseGaussian<Real>>& gaussians) {
  return mixture_of<Real>(weights, [&](std::size_t b) { return gaussians[b]; });
}
/// Mean and spread of the drawn poses.
template <class Real>
PoseMoments spread_of(const Weights<Real>& weights, const std::vector<BasicPose<Real>>& poses) {
  return mixture_of<Real>(weights, [&](std::size_t b) { return PoseGaussian<Real>{poses[b], {}}; });
}

/// What the particles together believe about one landmark: mean and covariance of the mixture.
template <class Real>
LandmarkEstimate mixture_of_landmarks(const Weights<Real>& weights,
                                      const std::vector<LandmarkGaussian<Real>>& landmarks) {
  const auto first = weighted_sums<Real, 2>(weights, [&](std::size_t b) {
    return std::array<Real, 2>{landmarks[b].mean.x, landmarks[b].mean.y};
  });
  const Point mean{first[0], first[1]};
  const auto C = weighted_sums<Real, 3>(weights, [&](std::size_t b) {
    const Real x = landmarks[b].mean.x - mean.x, y = landmarks[b].mean.y - mean.y;
    const Symmetric2<Real>& P = landmarks[b].covariance;
    return std::array<Real, 3>{P.xx + x * x, P.xy + x * y, P.yy + y * y};
  });
  return {{mean.x, mean.y}, Eigen::Matrix2d{{C[0], C[1]}, {C[1], C[2]}}};
}

/// Second moments of a cloud of drawn poses from which its estimate after any common motion follows
/// in closed form: between scans an estimate costs the same for 10 and for 10,000 particles. With v
/// = (x, y, h, cos h, sin h), h the heading less its mean, the moved cloud is linear in v.
class CloudMoments {
 public:
  template <class Real>
  CloudMoments(const Weights<Real>& weights, const std::vector<BasicPose<Real>>& poses)
      : mean_(weighted_mean<Real>(weights, [&](std::size_t b) { return poses[b]; })),
        ahead_(direction_of(mean_.heading)) {
    const auto terms = [&](std::size_t b) {
      const Real x = poses[b].x - mean_.x, y = poses[b].y - mean_.y;
      const Real h = wrap(poses[b].heading - mean_.heading);
      const Direction<Real> d = direction_of(h);
      const Real c = d.cosine - 1.0, s = d.sine;
      return std::array<Real, 18>{h,     c,     s,     x * x, x * y, x * h, x * c, x * s, y * y,
                                  y * h, y * c, y * s, h * h, h * c, h * s, c * c, c * s, s * s};
    };
    const auto [h, c, s, xx, xy, xh, xc, xs, yy, yh, yc, ys, hh, hc, hs, cc, cs, ss] =
        weighted_sums<Real, 18>(weights, terms);
    turn_ = {1.0 + c, s};
    turn_squares_ = {1.0 + 2.0 * c + cc, s + cs, ss};
    pose_ = {xx, xy, yy, xh, yh, hh};
    // Headings more than half a turn from the mean wrap, so that their mean is not quite zero; they
    // are deviations from the mean heading all the same.
    x_ = {xc, xs}, y_ = {yc, ys}, h_ = {hc - h * c, hs - h * s};
    c_ = {cc - c * c, cs - c * s}, s_ = {cs - c * s, ss - s * s};
  }

  /// The estimate after the cloud moved by `increment`.
  PoseEstimate moved_by(const MotionIncrement& increment) const;

 private:
  Pose mean_;
  Direction<double> ahead_;          ///< of the mean heading
  Direction<double> turn_;           ///< mean of (cos h, sin h)
  Symmetric2<double> turn_squares_;  ///< mean of their squares and product
  Symmetric3<double> pose_;          ///< covariance of (x, y, h)
  Point x_, y_, h_, c_, s_;          ///< of each element of v with (cos h, sin h)
};

}  // namespace montecarta::filters
