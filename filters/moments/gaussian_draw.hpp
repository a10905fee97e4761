// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/random/normals.hpp"
#include "filters/moments/gaussians.hpp"

namespace montecarta::filters {

/// A pose Gaussian as the image of a standard normal. The factor is that in the frame of the
/// vehicle, so that a turned world gives a turned draw.
template <class Real>
struct PoseFactor {
  BasicPose<Real> mean;
  Direction<Real> ahead;
  Cholesky3<Real> L;

  explicit PoseFactor(const PoseGaussian<Real>& gaussian)
      : mean(gaussian.mean),
        ahead(direction_of(gaussian.mean.heading)),
        L(turned(gaussian.covariance, Direction<Real>{ahead.cosine, -ahead.sine})) {}

  /// mean + factor (e0, e1, e2).
  BasicPose<Real> at(const Real& e0, const Real& e1, const Real& e2) const {
    const Real x = L.xx * e0, y = L.yx * e0 + L.yy * e1;
    return {mean.x + ahead.cosine * x - ahead.sine * y, mean.y + ahead.sine * x + ahead.cosine * y,
            wrap(mean.heading + L.hx * e0 + L.hy * e1 + L.hh * e2)};
  }
};

/// `scale` times the standard normals 0, 1, 2 of a stream, through the factor.
template <class Real>
BasicPose<Real> draw_from(const PoseFactor<Real>& factor, const StreamIdentity& identity,
                          const Real& scale = Real(1.0)) {
  const auto [e0, e1] = normal_pairs<Real>(identity, 0);
  const Real e2 = normal_pairs<Real>(identity, 1).first;
  return factor.at(scale * e0, scale * e1, scale * e2);
}

/// log N(pose; gaussian) without 2 pi, which cancels in a ratio; the covariance is made invertible
/// by 1e-12 m^2 and 1e-14 rad^2 (EQUATIONS (6.3)).
template <class Real>
class PoseDensity {
 public:
  explicit PoseDensity(const PoseGaussian<Real>& gaussian)
      : mean_(gaussian.mean), L_(invertible(gaussian.covariance)) {
    log_determinant_ = log(L_.xx * L_.yy * L_.hh);
  }

  Real operator()(const BasicPose<Real>& pose) const {
    const Real a = (pose.x - mean_.x) / L_.xx;
    const Real b = (pose.y - mean_.y - L_.yx * a) / L_.yy;
    const Real h = (wrap(Real(pose.heading - mean_.heading)) - L_.hx * a - L_.hy * b) / L_.hh;
    return -0.5 * (a * a + b * b + h * h) - log_determinant_;
  }

 private:
  static Symmetric3<Real> invertible(Symmetric3<Real> P) {
    P.xx += Real(1e-12), P.yy += Real(1e-12), P.hh += Real(1e-14);
    return P;
  }

  BasicPose<Real> mean_;
  Cholesky3<Real> L_;
  Real log_determinant_;
};

}  // namespace montecarta::filters
