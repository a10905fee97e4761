// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/pose.hpp"
#include "engine/numbers/angle.hpp"
#include "engine/random/stream.hpp"
#include "filters/models/eigen_jacobians.hpp"

#include <Eigen/Dense>
#include <Eigen/Geometry>

#include <cmath>

/// The textbook versions of the filters, in plain Eigen: this is where to read an algorithm and to
/// try a change. The fast filters compute the same, and tests compare both.
namespace montecarta::filters::plain {

template <int N>
using Vector = Eigen::Matrix<double, N, 1>;
template <int N, int M = N>
using Matrix = Eigen::Matrix<double, N, M>;
/// Of any size up to 8 rows and 16 columns (sigma points), without an allocation. A vector holds a
/// row or a column.
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 16, 1>;
using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 8, 16>;

inline Pose as_pose(const Vector<3>& x) { return {x(0), x(1), wrap(x(2))}; }
inline Vector<3> to_vector(const Pose& pose) { return {pose.x, pose.y, pose.heading}; }

/// J p, the displacement of p per rad of a turn about the origin (EQUATIONS (15.3)).
inline Vector<2> quarter_turned(const Vector<2>& p) { return {-p.y(), p.x()}; }

/// K = C S^-1 for a covariance S, by its Cholesky factor.
template <int N, int M>
Matrix<N, M> gain(const Matrix<N, M>& C, const Matrix<M>& S) {
  return S.llt().solve(C.transpose()).transpose();
}

/// v' S^-1 v.
inline double squared_distance(const Vector<2>& v, const Matrix<2>& S) {
  return v.dot(S.llt().solve(v));
}

/// log N(v; S) of EQUATIONS (0.1), by the Cholesky factor of S, which replaces S column by column.
template <int N>
double log_gaussian(const Vector<N>& v, Matrix<N> S) {
  Vector<N> white = v;
  double log_det = 0.0;
  for (Eigen::Index j = 0; j < v.size(); ++j) {
    const double pivot = std::sqrt(S(j, j));
    white(j) /= pivot;
    log_det += 2.0 * std::log(pivot);
    for (Eigen::Index i = j + 1; i < v.size(); ++i) {
      S(i, j) /= pivot;
      white(i) -= S(i, j) * white(j);
      for (Eigen::Index k = j + 1; k <= i; ++k) S(i, k) -= S(i, j) * S(k, j);
    }
  }
  const auto size = static_cast<double>(v.size());
  return -0.5 * (white.squaredNorm() + log_det + size * std::log(kTwoPi));
}

/// The innovation of one detection of range and bearing, and its covariance.
struct Innovation {
  Vector<2> nu;
  Matrix<2> S;
};
inline double log_gaussian(const Innovation& v) { return log_gaussian<2>(v.nu, v.S); }

/// Lower triangular L with L L' = P. A pivot that is zero but for rounding gives a zero column
/// (EQUATIONS, Notation).
inline SmallMatrix psd_chol(const SmallMatrix& P) {
  SmallMatrix L = SmallMatrix::Zero(P.rows(), P.rows());
  for (Eigen::Index j = 0; j < P.rows(); ++j) {
    const double pivot = P(j, j) - L.row(j).squaredNorm();
    if (pivot <= 1e-18 * (1.0 + std::abs(P(j, j)))) continue;
    L(j, j) = std::sqrt(pivot);
    for (Eigen::Index i = j + 1; i < P.rows(); ++i)
      L(i, j) = (P(i, j) - L.row(i).dot(L.row(j))) / L(j, j);
  }
  return L;
}

/// The square root of P that is lower triangular in the coordinates y = T x, T orthogonal.
inline SmallMatrix chol_in(const SmallMatrix& T, const SmallMatrix& P) {
  return T.transpose() * psd_chol(T * P * T.transpose());
}

/// The square root of the covariance of a pose that is lower triangular along, across and about
/// `heading`. In these coordinates a rotated world gives exactly the rotated draw.
inline Matrix<3> root_along(double heading, const Matrix<3>& P) {
  Matrix<3> T = Matrix<3>::Identity();
  T.topLeftCorner<2, 2>() = Eigen::Rotation2D<double>(-heading).toRotationMatrix();
  return chol_in(T, P);
}

/// A draw from N(mean, root root').
inline Vector<3> drawn_from(const Vector<3>& mean, const Matrix<3>& root, RngStream stream) {
  Vector<3> normals;
  for (double& one : normals) one = stream.normal();
  Vector<3> pose = mean + root * normals;
  pose(2) = wrap(pose(2));
  return pose;
}

/// log N(pose - mean; P). P may be singular, so that 1e-12 m^2 and 1e-14 rad^2 are added (EQUATIONS
/// 6).
inline double log_density(const Vector<3>& pose, const Vector<3>& mean, const Matrix<3>& P) {
  Matrix<3> S = P;
  S.diagonal() += Vector<3>(1e-12, 1e-12, 1e-14);
  return log_gaussian<3>(boxminus(as_pose(pose), as_pose(mean)), S);
}

}  // namespace montecarta::filters::plain
