// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace montecarta::experiments {

/// Whether a matrix is symmetric and positive semidefinite, as far as that can be told.
bool is_covariance(const Eigen::MatrixXd& P);

/// The covariance {d, d} that no difference of two errors with the covariances `a` and `b` exceeds,
/// whatever their correlation is (STATISTICS (19.5)): (1 + t) a + (1 + 1/t) b, with a t that makes
/// it small.
Eigen::MatrixXd largest_covariance_of_difference(const Eigen::MatrixXd& a,
                                                 const Eigen::MatrixXd& b);

}  // namespace montecarta::experiments
