// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/joint/retraction.hpp"

#include <Eigen/Core>

namespace montecarta::filters {

/// Columns over the points of a map as combinations of a few orthonormal vectors: columns = vectors
/// coefficients, to rounding.
class Basis {
 public:
  /// Spans `columns`, which are used up. With the invariant error the basis is closed under a
  /// quarter turn of every point: it has vectors q and J q side by side, and the pair of
  /// coefficients of a column turns as the column's points do.
  void span(Eigen::MatrixXd& columns, Retraction retraction);
  void clear() { size_ = 0; }

  /// How many vectors: an even number, in the worst case two for every column.
  Eigen::Index size() const { return size_; }
  auto vectors() const { return vectors_.leftCols(size_); }
  auto coefficients() const { return coefficients_.topRows(size_); }

 private:
  void make_room(const Eigen::MatrixXd& columns, Eigen::Index most);

  Eigen::MatrixXd vectors_, coefficients_;
  Eigen::Index size_ = 0;
};

}  // namespace montecarta::filters
