// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/plain/gaussian.hpp"

#include <cmath>

/// Covariances as square roots (EQUATIONS 3, square-root form).
namespace montecarta::filters::plain {

/// The lower triangular L, diagonal not negative, with L L' = A A' (the "qr" of the papers), by
/// Householder reflections: each row of A is mirrored onto its axis.
template <int N, int M>
Matrix<N> tria(const Matrix<N, M>& A) {
  static_assert(N <= M);
  Matrix<N, M> L = A;
  for (int i = 0; i < N; ++i) {
    Vector<M> mirror = L.row(i);
    mirror.head(i).setZero();
    if (mirror.isZero(0.0)) continue;
    mirror(i) += std::copysign(mirror.norm(), mirror(i));
    const Vector<N> along = L * mirror * (2.0 / mirror.squaredNorm());
    L -= along * mirror.transpose();
  }
  Matrix<N> lower = Matrix<N>::Zero();
  for (int i = 0; i < N; ++i)
    lower.col(i).tail(N - i) = (L(i, i) < 0.0 ? -1.0 : 1.0) * L.col(i).tail(N - i);
  return lower;
}

/// tria([A B]).
template <int N, int A, int B>
Matrix<N> tria_of(const Matrix<N, A>& a, const Matrix<N, B>& b) {
  Matrix<N, A + B> columns;
  columns << a, b;
  return tria<N, A + B>(columns);
}
/// tria([A B C]).
template <int N, int A, int B, int C>
Matrix<N> tria_of(const Matrix<N, A>& a, const Matrix<N, B>& b, const Matrix<N, C>& c) {
  Matrix<N, A + B + C> columns;
  columns << a, b, c;
  return tria<N, A + B + C>(columns);
}

/// The square root of S S' that is lower triangular in the coordinates y = T x, T orthogonal.
template <int N>
Matrix<N> tria_in(const Matrix<N>& T, const Matrix<N>& S) {
  return T.transpose() * tria<N, N>(T * S);
}

/// K = (P_xz / Sy') / Sy with P_xz = cross (EQUATIONS (3.9)).
template <int N, int M>
Matrix<N, M> square_root_gain(const Matrix<N, M>& cross, const Matrix<M>& Sy) {
  const auto L = Sy.template triangularView<Eigen::Lower>();
  return L.transpose().solve(L.solve(cross.transpose())).transpose();
}

}  // namespace montecarta::filters::plain
