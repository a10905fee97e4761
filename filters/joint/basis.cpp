// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/basis.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta {
namespace {

/// What no vector stands for, as a share of the longest column: rounding, not approximation.
constexpr double kLeftOut = 1e-14;

/// Makes the next `Width` vectors of column `longest`, and takes their share out of all columns.
template <int Width>
void take_out(Eigen::Index longest, Eigen::MatrixXd& columns,
              Eigen::Ref<Eigen::Matrix<double, Eigen::Dynamic, Width>> vectors,
              Eigen::Ref<Eigen::MatrixXd> coefficients) {
  vectors.col(0) = columns.col(longest).normalized();
  if constexpr (Width == 2) {
    vectors.col(1) = vectors.col(0);
    apply(quarter_turn(), vectors.col(1).reshaped(2, columns.rows() / 2));
  }
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    for (int q = 0; q < Width; ++q) coefficients(q, j) = vectors.col(q).dot(columns.col(j));
    columns.col(j) -= vectors.lazyProduct(coefficients.col(j));
  }
}

}  // namespace

/// Gram and Schmidt, the longest of what is left first.
void Basis::span(Eigen::MatrixXd& columns, Retraction retraction) {
  const Eigen::Index width = retraction == Retraction::invariant ? 2 : 1;
  const Eigen::Index most = std::min(width * columns.cols(), columns.rows());
  make_room(columns, most + 1);
  double least_squared = 0.0;
  for (size_ = 0; size_ < most; size_ += width) {
    Eigen::Index longest = 0;
    const double squared = columns.colwise().squaredNorm().maxCoeff(&longest);
    if (size_ == 0) least_squared = kLeftOut * kLeftOut * squared;
    if (!(squared > least_squared)) break;
    auto shares = coefficients_.middleRows(size_, width);
    if (width == 2) {
      take_out<2>(longest, columns, vectors_.middleCols<2>(size_), shares);
    } else {
      take_out<1>(longest, columns, vectors_.col(size_), shares);
    }
  }
  if (size_ % 2 == 0) return;
  vectors_.col(size_).setZero();
  coefficients_.row(size_++).setZero();
}

void Basis::make_room(const Eigen::MatrixXd& columns, Eigen::Index most) {
  if (vectors_.rows() != columns.rows() || vectors_.cols() < most) {
    vectors_.resize(columns.rows(), most);
  }
  coefficients_.resize(most, columns.cols());
}

}  // namespace montecarta
