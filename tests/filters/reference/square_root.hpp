// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/filters/reference/unscented.hpp"

#include <Eigen/Dense>

#include <cmath>

/// The square-root form and the central differences of EQUATIONS 3, literally.
namespace montecarta::filters::reference {

/// The lower triangular L, diagonal not negative, with L L' = A A' (the papers' "qr"): each row of
/// A is mirrored onto its axis. Eigen's own takes the compiler seconds for each size.
template <int N, int M>
Eigen::Matrix<double, N, N> tria(const Eigen::Matrix<double, N, M>& A) {
  static_assert(N <= M);
  Eigen::Matrix<double, N, M> L = A;
  for (int i = 0; i < N; ++i) {
    Vector<M> mirror = L.row(i);
    mirror.head(i).setZero();
    if (mirror.isZero(0.0)) continue;
    mirror(i) += std::copysign(mirror.norm(), mirror(i));
    const Vector<N> along = L * mirror * (2.0 / mirror.squaredNorm());
    L -= along * mirror.transpose();
  }
  Eigen::Matrix<double, N, N> lower = Eigen::Matrix<double, N, N>::Zero();
  for (int i = 0; i < N; ++i) {
    lower.col(i).tail(N - i) = (L(i, i) < 0.0 ? -1.0 : 1.0) * L.col(i).tail(N - i);
  }
  return lower;
}

/// S S' -> S S' - U U', one hyperbolic downdate per column of U; false where that is not positive.
template <int N, int M>
[[nodiscard]] bool cholupdate(Eigen::Matrix<double, N, N>& S,
                              const Eigen::Matrix<double, N, M>& U) {
  for (int c = 0; c < M; ++c) {
    Vector<N> u = U.col(c);
    for (int k = 0; k < N; ++k) {
      const double square = S(k, k) * S(k, k) - u(k) * u(k);
      if (square <= 0.0) return false;
      const double root = std::sqrt(square), cosine = root / S(k, k), sine = u(k) / S(k, k);
      S(k, k) = root;
      for (int i = k + 1; i < N; ++i) {
        S(i, k) = (S(i, k) - sine * u(i)) / cosine;
        u(i) = cosine * u(i) - sine * S(i, k);
      }
    }
  }
  return true;
}

/// First (A) and second (B) differences of a model, and the mean of its image (EQUATIONS 3).
template <int N, int M>
struct Differences {
  Vector<M> mean;
  Eigen::Matrix<double, M, N> A, B;
};

template <int M, int Angle, int N, class Model>
Differences<N, M> central_differences(const Vector<N>& x, const Eigen::Matrix<double, N, N>& S,
                                      double h, const Model& model) {
  const Vector<M> centre = model(x);
  Differences<N, M> image;
  Vector<M> sum = Vector<M>::Zero();  // of the outer points, as differences from the centre's image
  for (int i = 0; i < N; ++i) {
    const Vector<N> ahead = x + h * S.col(i), behind = x - h * S.col(i);
    const Vector<M> plus = difference<Angle, M>(model(ahead), centre);
    const Vector<M> minus = difference<Angle, M>(model(behind), centre);
    image.A.col(i) = (plus - minus) / (2.0 * h);
    image.B.col(i) = std::sqrt(h * h - 1.0) / (2.0 * h * h) * (plus + minus);
    sum += plus + minus;
  }
  image.mean = centre + 1.0 / (2.0 * h * h) * sum;
  if constexpr (Angle >= 0) image.mean(Angle) = wrap(image.mean(Angle));
  return image;
}

/// K = (P_xz / S_y') / S_y (EQUATIONS 3).
template <int N, int M>
Eigen::Matrix<double, N, M> gain(const Eigen::Matrix<double, N, M>& P_xz,
                                 const Eigen::Matrix<double, M, M>& S_y) {
  const Eigen::Matrix<double, M, M> inverse = S_y.inverse();
  const Eigen::Matrix<double, N, M> half = P_xz * inverse.transpose();
  return half * inverse;
}

/// The square root of S S' that is lower triangular in the coordinates y = T x, T orthogonal.
template <int N>
Eigen::Matrix<double, N, N> tria_in(const Eigen::Matrix<double, N, N>& T,
                                    const Eigen::Matrix<double, N, N>& S) {
  const Eigen::Matrix<double, N, N> turned = T * S;
  return T.transpose() * tria<N, N>(turned);
}

}  // namespace montecarta::filters::reference
