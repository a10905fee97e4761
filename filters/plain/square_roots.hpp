// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/plain/gaussian.hpp"

#include <cmath>
#include <initializer_list>

/// Covariances as square roots (EQUATIONS 3, square-root form).
namespace montecarta::filters::plain {

/// The lower triangular L, diagonal not negative, with L L' = A A' (the "qr" of the papers), by
/// Householder reflections: each row of A, which has no more rows than columns, is mirrored onto
/// its axis.
inline SmallMatrix tria(const SmallMatrix& A) {
  const Eigen::Index n = A.rows();
  SmallMatrix L = A;
  for (Eigen::Index i = 0; i < n; ++i) {
    SmallVector mirror = L.row(i);
    mirror.head(i).setZero();
    if (mirror.isZero(0.0)) continue;
    mirror(i) += std::copysign(mirror.norm(), mirror(i));
    const SmallVector along = L * mirror * (2.0 / mirror.squaredNorm());
    L -= along * mirror.transpose();
  }
  SmallMatrix lower = SmallMatrix::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    lower.col(i).tail(n - i) = (L(i, i) < 0.0 ? -1.0 : 1.0) * L.col(i).tail(n - i);
  return lower;
}

/// tria([A B ...]).
inline SmallMatrix tria_of(std::initializer_list<SmallMatrix> parts) {
  SmallMatrix columns(parts.begin()->rows(), 0);
  for (const SmallMatrix& part : parts) {
    columns.conservativeResize(Eigen::NoChange, columns.cols() + part.cols());
    columns.rightCols(part.cols()) = part;
  }
  return tria(columns);
}

/// The square root of S S' that is lower triangular in the coordinates y = T x, T orthogonal.
inline SmallMatrix tria_in(const SmallMatrix& T, const SmallMatrix& S) {
  return T.transpose() * tria(T * S);
}

/// K = (P_xz / Sy') / Sy with P_xz = cross (EQUATIONS (3.9)).
inline SmallMatrix square_root_gain(const SmallMatrix& cross, const SmallMatrix& Sy) {
  const auto L = Sy.triangularView<Eigen::Lower>();
  return L.transpose().solve(L.solve(cross.transpose())).transpose();
}

}  // namespace montecarta::filters::plain
