// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/difference_bound.hpp"

#include "analysis/run/nees.hpp"

#include <cmath>

namespace montecarta::experiments {

bool is_covariance(const Eigen::MatrixXd& P) {
  return analysis::imported_nees(Eigen::VectorXd::Zero(P.rows()), P).is_usable();
}

Eigen::MatrixXd largest_covariance_of_difference(const Eigen::MatrixXd& a,
                                                 const Eigen::MatrixXd& b) {
  double share_a = 0.0, share_b = 0.0;
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    const double sum = a(i, i) + b(i, i);
    if (!(sum > 0.0)) continue;
    share_a += a(i, i) / sum;
    share_b += b(i, i) / sum;
  }
  if (!(share_a > 0.0 && share_b > 0.0)) return a + b;
  const double t = std::sqrt(share_b / share_a);
  return (1.0 + t) * a + (1.0 + 1.0 / t) * b;
}

}  // namespace montecarta::experiments
