// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/basis.hpp"

#include "filters/joint/products.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace montecarta::filters {
namespace {

/// What no vector stands for, as a share of the longest column: rounding, not approximation.
constexpr double kLeftOut = 1e-14;

/// Index and squared norm of the longest column.
std::pair<Eigen::Index, double> longest_of(const Eigen::MatrixXd& columns) {
  std::pair<Eigen::Index, double> longest{0, 0.0};
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    const double squared = dot(columns.col(j), columns.col(j));
    if (squared > longest.second) longest = {j, squared};
  }
  return longest;
}

/// Makes the next `Width` vectors of column `longest`, and takes their share out of all columns.
template <int Width>
void take_out(Eigen::Index longest, double squared, Eigen::MatrixXd& columns,
              Eigen::Ref<Eigen::Matrix<double, Eigen::Dynamic, Width>> vectors,
              Eigen::Ref<Eigen::MatrixXd> coefficients) {
  vectors.col(0) = columns.col(longest) / std::sqrt(squared);
  if constexpr (Width == 2) {
    vectors.col(1) = vectors.col(0);
    apply(quarter_turn(), vectors.col(1).reshaped(2, columns.rows() / 2));
  }
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    Eigen::Matrix<double, Width, 1> share;
    for (int q = 0; q < Width; ++q) share(q) = dot(vectors.col(q), columns.col(j));
    coefficients.col(j) = share;
    add_combination(vectors, -share, columns.col(j));
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
    const auto [longest, squared] = longest_of(columns);
    if (size_ == 0) least_squared = kLeftOut * kLeftOut * squared;
    if (!(squared > least_squared)) break;
    auto shares = coefficients_.middleRows(size_, width);
    if (width == 2) {
      take_out<2>(longest, squared, columns, vectors_.middleCols<2>(size_), shares);
    } else {
      take_out<1>(longest, squared, columns, vectors_.col(size_), shares);
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

}  // namespace montecarta::filters
