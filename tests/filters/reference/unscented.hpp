// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/numbers/angle.hpp"
#include "tests/filters/reference/fast_slams.hpp"

#include <Eigen/Core>

#include <cmath>

namespace montecarta::filters::reference {

template <int N>
using Vector = Eigen::Matrix<double, N, 1>;

/// a - b, with component `Angle` (if any) wrapped.
template <int Angle, int M>
Vector<M> difference(const Vector<M>& a, const Vector<M>& b) {
  Vector<M> d = a - b;
  if constexpr (Angle >= 0) d(Angle) = wrap(d(Angle));
  return d;
}

/// Second moments of (x, F(x)).
template <int N, int M>
struct Image {
  Vector<M> mean;
  Eigen::Matrix<double, M, M> covariance;
  Eigen::Matrix<double, N, M> cross;
};

/// The scaled unscented transform as the textbook has it: 2N + 1 points about `x`, out of the
/// columns of the square root S, through `model`, with weights w0, wc0 and wi.
template <int M, int Angle, int N, class Model>
Image<N, M> unscented(const Vector<N>& x, const Eigen::Matrix<double, N, N>& S, const Unscented& u,
                      const Model& model) {
  const double lambda = u.alpha * u.alpha * (N + u.kappa) - N;
  const double w0 = lambda / (N + lambda), wi = 1.0 / (2.0 * (N + lambda));
  const double wc0 = w0 + 1.0 - u.alpha * u.alpha + u.beta;
  Eigen::Matrix<double, N, 2 * N + 1> X;
  X.col(0) = x;
  for (int j = 0; j < N; ++j) {
    X.col(1 + j) = x + std::sqrt(N + lambda) * S.col(j);
    X.col(1 + N + j) = x - std::sqrt(N + lambda) * S.col(j);
  }
  const Vector<M> centre = model(x);
  Eigen::Matrix<double, M, 2 * N + 1> Y;  // as differences from the centre's image
  for (int k = 0; k <= 2 * N; ++k) {
    const Vector<N> point = X.col(k);
    Y.col(k) = difference<Angle, M>(model(point), centre);
  }
  Vector<M> shift = w0 * Y.col(0);
  for (int k = 1; k <= 2 * N; ++k) shift += wi * Y.col(k);
  Image<N, M> image{centre + shift, wc0 * (Y.col(0) - shift) * (Y.col(0) - shift).transpose(),
                    wc0 * (X.col(0) - x) * (Y.col(0) - shift).transpose()};
  for (int k = 1; k <= 2 * N; ++k) {
    image.covariance += wi * (Y.col(k) - shift) * (Y.col(k) - shift).transpose();
    image.cross += wi * (X.col(k) - x) * (Y.col(k) - shift).transpose();
  }
  if constexpr (Angle >= 0) image.mean(Angle) = wrap(image.mean(Angle));
  return image;
}

}  // namespace montecarta::filters::reference
