// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/numbers/angle.hpp"

#include <Eigen/Dense>

#include <cmath>

namespace montecarta::reference {

/// log N(v; S), the zero-mean density of SPEC 0.
template <int N>
double log_gaussian(const Eigen::Matrix<double, N, 1>& v, const Eigen::Matrix<double, N, N>& S) {
  const Eigen::LLT<Eigen::Matrix<double, N, N>> L(S);
  const double log_det = 2.0 * L.matrixLLT().diagonal().array().log().sum();
  const double squared = L.matrixL().solve(v).squaredNorm();
  return -0.5 * (squared + log_det + static_cast<double>(v.size()) * std::log(kTwoPi));
}

/// Lower Cholesky factor that allows zero pivots: a pivot <= 1e-18 (1 + |P_jj|) gives a zero column
/// (SPEC 4).
inline Eigen::Matrix3d psd_chol(const Eigen::Matrix3d& P) {
  Eigen::Matrix3d L = Eigen::Matrix3d::Zero();
  for (int j = 0; j < 3; ++j) {
    const double pivot = P(j, j) - L.row(j).squaredNorm();
    if (pivot <= 1e-18 * (1.0 + std::abs(P(j, j)))) continue;
    L(j, j) = std::sqrt(pivot);
    for (int i = j + 1; i < 3; ++i) L(i, j) = (P(i, j) - L.row(i).dot(L.row(j))) / L(j, j);
  }
  return L;
}

}  // namespace montecarta::reference
