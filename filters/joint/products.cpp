// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/products.hpp"

#include <Eigen/Cholesky>

namespace montecarta::filters {
namespace {

constexpr Eigen::Index kGrain = 8;  // rows of a block in add_product()
constexpr Eigen::Index kBlock = 32;

}  // namespace

bool BlockedCholesky::factorise(const ConstMatrix& A) {
  n_ = A.rows();
  const Eigen::Index size = (n_ + kGrain - 1) / kGrain * kGrain;
  L_.setIdentity(size, size);
  L_.topLeftCorner(n_, n_) = A;
  for (Eigen::Index first = 0; first < size; first += kBlock) {
    const Eigen::Index width = std::min(kBlock, size - first), rest = size - first - width;
    Eigen::Ref<Eigen::MatrixXd> own = L_.block(first, first, width, width);
    if (Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(own).info() != Eigen::Success) return false;
    auto below = L_.block(first + width, first, rest, width);
    own.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(below);
    if (rest > 0) add_product(below, -below, Part::lower, L_.bottomRightCorner(rest, rest));
  }
  return true;
}

void BlockedCholesky::solve_in_place(Eigen::VectorXd& b) const {
  const auto L = L_.topLeftCorner(n_, n_).triangularView<Eigen::Lower>();
  L.solveInPlace(b);
  L.transpose().solveInPlace(b);
}

// P = U U', U = L^-T.
void BlockedCholesky::inverse(Eigen::Ref<Eigen::MatrixXd> P) const {
  const Eigen::Index size = L_.rows();
  Eigen::MatrixXd U = Eigen::MatrixXd::Zero(size, size), inverse = U;
  for (Eigen::Index first = 0; first < size; first += kBlock) {
    const Eigen::Index width = std::min(kBlock, size - first);
    Eigen::MatrixXd own = Eigen::MatrixXd::Identity(width, width);
    L_.block(first, first, width, width).triangularView<Eigen::Lower>().solveInPlace(own);
    if (first > 0) {
      Eigen::MatrixXd above = Eigen::MatrixXd::Zero(first, width);
      add_product(U.topLeftCorner(first, first), L_.block(first, 0, width, first), Part::whole,
                  above);
      add_product(above, -own, Part::whole, U.block(0, first, first, width));
    }
    U.block(first, first, width, width) = own.transpose();
    const auto columns = U.block(0, first, first + width, width);
    add_product(columns, columns, Part::lower, inverse.topLeftCorner(first + width, first + width));
  }
  P = inverse.topLeftCorner(n_, n_).selfadjointView<Eigen::Lower>();
}

}  // namespace montecarta::filters
