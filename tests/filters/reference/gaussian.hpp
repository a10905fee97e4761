// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/numbers/angle.hpp"

#include <Eigen/Dense>

#include <cmath>

/// What every reference is made of. References are to be read beside the papers, so they divide by
/// two-by-two matrices as those write it, K = P H' S^-1; nowhere else does anything invert.
namespace montecarta::filters::reference {

/// log N(v; S), the density (0.1) of EQUATIONS, by the Cholesky factor of S, which takes its place
/// column by column. Eigen's own takes the compiler seconds a size.
template <int N>
double log_gaussian(const Eigen::Matrix<double, N, 1>& v, Eigen::Matrix<double, N, N> S) {
  Eigen::Matrix<double, N, 1> white = v;
  double log_det = 0.0, squared = 0.0;
  for (Eigen::Index j = 0; j < v.size(); ++j) {
    const double pivot = std::sqrt(S(j, j));
    white(j) /= pivot;
    squared += white(j) * white(j);
    log_det += 2.0 * std::log(pivot);
    for (Eigen::Index i = j + 1; i < v.size(); ++i) {
      S(i, j) /= pivot;
      white(i) -= S(i, j) * white(j);
      for (Eigen::Index k = j + 1; k <= i; ++k) S(i, k) -= S(i, j) * S(k, j);
    }
  }
  return -0.5 * (squared + log_det + static_cast<double>(v.size()) * std::log(kTwoPi));
}

/// Lower Cholesky factor that allows zero pivots: a pivot <= 1e-18 (1 + |P_jj|) gives a zero column
/// (EQUATIONS, Notation).
template <int N>
Eigen::Matrix<double, N, N> psd_chol(const Eigen::Matrix<double, N, N>& P) {
  Eigen::Matrix<double, N, N> L = Eigen::Matrix<double, N, N>::Zero();
  for (int j = 0; j < N; ++j) {
    const double pivot = P(j, j) - L.row(j).squaredNorm();
    if (pivot <= 1e-18 * (1.0 + std::abs(P(j, j)))) continue;
    L(j, j) = std::sqrt(pivot);
    for (int i = j + 1; i < N; ++i) L(i, j) = (P(i, j) - L.row(i).dot(L.row(j))) / L(j, j);
  }
  return L;
}

/// The square root of P that is lower triangular in the coordinates y = T x, T orthogonal.
template <int N>
Eigen::Matrix<double, N, N> chol_in(const Eigen::Matrix<double, N, N>& T,
                                    const Eigen::Matrix<double, N, N>& P) {
  return T.transpose() * psd_chol<N>(T * P * T.transpose());
}

}  // namespace montecarta::filters::reference
