// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace montecarta::analysis {

/// Eigenvalues of a symmetric matrix, in increasing order, and its eigenvectors as columns.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};

/// Reads the lower triangle of the matrix.
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& matrix);

/// The eigenvalues alone, in less time.
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& matrix);

}  // namespace montecarta::analysis
