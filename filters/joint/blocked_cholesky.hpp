// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/joint/products.hpp"

#include <Eigen/Core>

namespace montecarta::filters {

/// A = L L' of a large symmetric matrix, block by block: nearly all of it is add_product(), which
/// uses whole registers and has the same bits on every processor.
class BlockedCholesky {
 public:
  /// Of the lower triangle of A; false where it is not positive definite.
  [[nodiscard]] bool factorise(const ConstMatrix& A);

  /// Rows of A.
  Eigen::Index rows() const { return n_; }

  /// b <- A^-1 b.
  void solve_in_place(Eigen::VectorXd& b) const;

  /// P = A^-1.
  void inverse(Eigen::Ref<Eigen::MatrixXd> P) const;

 private:
  Eigen::Index n_ = 0;
  Eigen::MatrixXd L_;  ///< and, above its blocks on the diagonal, what A had there
};

}  // namespace montecarta::filters
