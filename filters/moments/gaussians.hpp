// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/random/stream.hpp"
#include "filters/models/range_bearing.hpp"

#include <Eigen/Core>

namespace montecarta::filters {

/// A column over (x, y, heading).
template <class Real>
struct Column3 {
  Real x, y, h;

  [[gnu::always_inline]] friend Column3 operator+(const Column3& a, const Column3& b) {
    return {a.x + b.x, a.y + b.y, a.h + b.h};
  }
  [[gnu::always_inline]] friend Column3 operator-(const Column3& a, const Column3& b) {
    return {a.x - b.x, a.y - b.y, a.h - b.h};
  }
  [[gnu::always_inline]] friend Column3 operator*(const Real& factor, const Column3& a) {
    return {factor * a.x, factor * a.y, factor * a.h};
  }
};

/// A symmetric matrix over (x, y, heading).
template <class Real>
struct Symmetric3 {
  Real xx{}, xy{}, yy{};  ///< [m^2]
  Real xh{}, yh{};        ///< [m rad]
  Real hh{};              ///< [rad^2]

  [[gnu::always_inline]] friend Symmetric3 operator+(const Symmetric3& A, const Symmetric3& B) {
    return {A.xx + B.xx, A.xy + B.xy, A.yy + B.yy, A.xh + B.xh, A.yh + B.yh, A.hh + B.hh};
  }
  [[gnu::always_inline]] friend Symmetric3 operator-(const Symmetric3& A, const Symmetric3& B) {
    return {A.xx - B.xx, A.xy - B.xy, A.yy - B.yy, A.xh - B.xh, A.yh - B.yh, A.hh - B.hh};
  }
  [[gnu::always_inline]] friend Symmetric3 operator*(double factor, const Symmetric3& P) {
    return {factor * P.xx, factor * P.xy, factor * P.yy,
            factor * P.xh, factor * P.yh, factor * P.hh};
  }
};

/// Converts to a matrix.
inline Eigen::Matrix3d symmetric(const Symmetric3<double>& P) {
  Eigen::Matrix3d matrix;
  matrix << P.xx, P.xy, P.xh, P.xy, P.yy, P.yh, P.xh, P.yh, P.hh;
  return matrix;
}
/// Converts from a matrix; only its upper triangle is read.
inline Symmetric3<double> symmetric_of(const Eigen::Matrix3d& P) {
  return {P(0, 0), P(0, 1), P(1, 1), P(0, 2), P(1, 2), P(2, 2)};
}
/// Copies one matrix to every lane.
template <class Real>
Symmetric3<Real> in_every_lane(const Symmetric3<double>& P) {
  return {P.xx, P.xy, P.yy, P.xh, P.yh, P.hh};
}

/// R P R', where R rotates (x, y) by the angle of `d` and leaves the heading.
template <class Real>
[[gnu::always_inline]] inline Symmetric3<Real> turned(const Symmetric3<Real>& P,
                                                      const Direction<Real>& d) {
  const Real c = d.cosine, s = d.sine;
  const Real along_x = c * P.xx - s * P.xy, along_y = c * P.xy - s * P.yy;
  const Real across_x = s * P.xx + c * P.xy, across_y = s * P.xy + c * P.yy;
  return {.xx = along_x * c - along_y * s,
          .xy = along_x * s + along_y * c,
          .yy = across_x * s + across_y * c,
          .xh = c * P.xh - s * P.yh,
          .yh = s * P.xh + c * P.yh,
          .hh = P.hh};
}

/// F P F' for F = [1 0 x; 0 1 y; 0 0 1], the Fx of a step (EQUATIONS 1).
template <class Real>
[[gnu::always_inline]] inline Symmetric3<Real> sheared(const Symmetric3<Real>& P, const Real& x,
                                                       const Real& y) {
  const Real xh = P.xh + x * P.hh, yh = P.yh + y * P.hh;
  return {
      P.xx + x * P.xh + x * xh, P.xy + y * P.xh + x * yh, P.yy + y * P.yh + y * yh, xh, yh, P.hh};
}

/// A symmetric matrix over (x, y) [m^2] or over the components of a Measurement.
template <class Real>
struct Symmetric2 {
  Real xx{}, xy{}, yy{};

  [[gnu::always_inline]] friend Symmetric2 operator+(const Symmetric2& A, const Symmetric2& B) {
    return {A.xx + B.xx, A.xy + B.xy, A.yy + B.yy};
  }
  [[gnu::always_inline]] friend Symmetric2 operator-(const Symmetric2& A, const Symmetric2& B) {
    return {A.xx - B.xx, A.xy - B.xy, A.yy - B.yy};
  }
  [[gnu::always_inline]] friend Symmetric2 operator*(const Real& factor, const Symmetric2& P) {
    return {factor * P.xx, factor * P.xy, factor * P.yy};
  }
  [[gnu::always_inline]] Real determinant() const { return xx * yy - xy * xy; }
  /// v' A^-1 v times the determinant, for v = (x, y).
  [[gnu::always_inline]] Real adjugate_form(const Real& x, const Real& y) const {
    return yy * x * x - 2.0 * xy * x * y + xx * y * y;
  }
};

/// weight v v'; `weight` is the same for all lanes or differs between them.
template <class Weight, class Real>
[[gnu::always_inline]] inline Symmetric2<Real> outer(const Weight& weight,
                                                     const Measurement<Real>& v) {
  const Real first = weight * v.first, second = weight * v.second;
  return {first * v.first, first * v.second, second * v.second};
}
/// a b' for two parallel columns, which is symmetric.
template <class Real>
[[gnu::always_inline]] inline Symmetric3<Real> outer(const Column3<Real>& a,
                                                     const Column3<Real>& b) {
  return {a.x * b.x, a.x * b.y, a.y * b.y, a.x * b.h, a.y * b.h, a.h * b.h};
}

using engine::select;

/// A in the lanes of `use`, else B.
template <class Real, class Mask>
[[gnu::always_inline]] inline Symmetric2<Real> select(const Mask& use, const Symmetric2<Real>& A,
                                                      const Symmetric2<Real>& B) {
  return {select(use, A.xx, B.xx), select(use, A.xy, B.xy), select(use, A.yy, B.yy)};
}

/// The estimate of one particle of its own pose since the last draw.
template <class Real>
struct PoseGaussian {
  BasicPose<Real> mean{};
  Symmetric3<Real> covariance{};
};

/// The pose in one lane.
template <class Real>
Pose of_lane(const BasicPose<Real>& block, std::size_t lane) {
  return {get(block.x, lane), get(block.y, lane), get(block.heading, lane)};
}
/// The Gaussian of the particle in one lane.
template <class Real>
PoseGaussian<double> of_lane(const PoseGaussian<Real>& block, std::size_t lane) {
  const auto& [m, P] = block;
  return {of_lane(m, lane),
          {get(P.xx, lane), get(P.xy, lane), get(P.yy, lane), get(P.xh, lane), get(P.yh, lane),
           get(P.hh, lane)}};
}

/// The estimate of one landmark by one particle.
template <class Real>
struct LandmarkGaussian {
  BasicPoint<Real> mean{};
  Symmetric2<Real> covariance{};
};

/// The Gaussian of a landmark, to be overloaded for filters that keep landmarks in another form.
template <class Real>
[[gnu::always_inline]] inline const LandmarkGaussian<Real>& gaussian_of(
    const LandmarkGaussian<Real>& landmark) {
  return landmark;
}

/// Adds `weight` times column column' to P.
[[gnu::always_inline]] inline void add_outer(Symmetric3<double>& P, double weight,
                                             const Column3<double>& column) {
  const double x = weight * column.x, y = weight * column.y;
  P.xx = fma(x, column.x, P.xx);
  P.xy = fma(x, column.y, P.xy);
  P.yy = fma(y, column.y, P.yy);
  P.xh = fma(x, column.h, P.xh);
  P.yh = fma(y, column.h, P.yh);
  P.hh = fma(weight * column.h, column.h, P.hh);
}

/// Lower triangular Cholesky factor. A pivot that is zero up to rounding gives a zero column.
template <class Real>
struct Cholesky3 {
  Real xx, yx, yy, hx, hy, hh;
  Real faults{0.0};  ///< pivots too negative for rounding: not a covariance

  [[gnu::always_inline]] explicit Cholesky3(const Symmetric3<Real>& P) {
    Real inverse = pivot(P.xx, P.xx, xx);
    yx = P.xy * inverse;
    hx = P.xh * inverse;
    inverse = pivot(P.yy - yx * yx, P.yy, yy);
    hy = (P.yh - hx * yx) * inverse;
    pivot(P.hh - hx * hx - hy * hy, P.hh, hh);
  }

 private:
  /// Returns 1 / root, or 0 if the pivot is zero.
  [[gnu::always_inline]] Real pivot(const Real& square, const Real& diagonal, Real& root) {
    faults += select(square < -1e-12 * diagonal, Real(1.0), Real(0.0));
    const auto positive = square > 1e-18 * (Real(1.0) + diagonal);
    root = sqrt(select(positive, square, Real(0.0)));
    return select(positive, Real(1.0) / root, Real(0.0));
  }
};

/// A pose Gaussian as the image of a standard normal variable. The factor is taken in the frame of
/// the vehicle, so that a rotated world gives the rotated draw.
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

/// Draws a pose: the factor times `scale` times the standard normals 0, 1, 2 of a stream.
template <class Real>
BasicPose<Real> draw_from(const PoseFactor<Real>& factor, const StreamIdentity& identity,
                          const Real& scale = Real(1.0)) {
  const auto [e0, e1] = normal_pairs<Real>(identity, 0);
  const Real e2 = normal_pairs<Real>(identity, 1).first;
  return factor.at(scale * e0, scale * e1, scale * e2);
}

/// log N(pose; gaussian) without the factor 2 pi, which cancels in a ratio. The covariance is made
/// invertible by adding 1e-12 m^2 and 1e-14 rad^2 (EQUATIONS (6.3)).
template <class Real>
class PoseDensity {
 public:
  explicit PoseDensity(const PoseGaussian<Real>& gaussian)
      : mean_(gaussian.mean), L_(invertible(gaussian.covariance)) {
    log_determinant_ = log(L_.xx * L_.yy * L_.hh);
  }

  Real operator()(const BasicPose<Real>& pose) const {
    return -0.5 * squared_distance(pose) - log_determinant_;
  }
  /// Square of the distance of `pose` from the mean, in standard deviations.
  Real squared_distance(const BasicPose<Real>& pose) const {
    const Real a = (pose.x - mean_.x) / L_.xx;
    const Real b = (pose.y - mean_.y - L_.yx * a) / L_.yy;
    const Real h = (wrap(Real(pose.heading - mean_.heading)) - L_.hx * a - L_.hy * b) / L_.hh;
    return a * a + b * b + h * h;
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
