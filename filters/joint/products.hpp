// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/errors.hpp"
#include "engine/numbers/real.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

/// Products of matrices with many rows. Eigen is built without its own vectorisation, since there
/// the order of sums and the use of fused products depend on the width of a register. These
/// functions have the same order on every processor and use whole registers.
namespace montecarta::filters {

using ConstMatrix = Eigen::Ref<const Eigen::MatrixXd>;
using ConstVector = Eigen::Ref<const Eigen::VectorXd>;

/// a'b, in sixteen partial sums.
inline double dot(const ConstVector& a, const ConstVector& b) {
  constexpr Eigen::Index size = Lanes::kSize;
  const Eigen::Index n = a.size();
  Lanes even(0.0), odd(0.0);
  Eigen::Index i = 0;
  for (; i + 2 * size <= n; i += 2 * size) {
    even = fma(Lanes::load_unaligned(a.data() + i), Lanes::load_unaligned(b.data() + i), even);
    odd = fma(Lanes::load_unaligned(a.data() + i + size),
              Lanes::load_unaligned(b.data() + i + size), odd);
  }
  double sum = sum_of_lanes(even + odd);
  for (; i < n; ++i) sum = std::fma(a(i), b(i), sum);
  return sum;
}

/// c += A b, in the order of the columns of A.
inline void add_combination(const ConstMatrix& A, const ConstVector& b,
                            Eigen::Ref<Eigen::VectorXd> c) {
  const Eigen::Index n = A.rows();
  double* __restrict sum = c.data();
  Eigen::Index k = 0;
  for (; k + 4 <= A.cols(); k += 4) {  // four at once: a quarter of the loads and stores of c
    const double *a0 = A.col(k).data(), *a1 = A.col(k + 1).data(), *a2 = A.col(k + 2).data(),
                 *a3 = A.col(k + 3).data();
    const double b0 = b(k), b1 = b(k + 1), b2 = b(k + 2), b3 = b(k + 3);
    for (Eigen::Index i = 0; i < n; ++i) {
      sum[i] = std::fma(a3[i], b3,
                        std::fma(a2[i], b2, std::fma(a1[i], b1, std::fma(a0[i], b0, sum[i]))));
    }
  }
  for (; k < A.cols(); ++k) {
    const double* a = A.col(k).data();
    const double factor = b(k);
    for (Eigen::Index i = 0; i < n; ++i) sum[i] = std::fma(a[i], factor, sum[i]);
  }
}

/// The part of a product that is computed.
enum class Part {
  whole,
  lower  ///< the lower triangle, and all of the 8 x 8 blocks on the diagonal
};

/// C += A B' for eight rows of N columns that begin at `c`, with A packed.
template <std::size_t N>
[[gnu::always_inline]] inline void add_block(const double* a, const Eigen::MatrixXd& factors,
                                             Eigen::Index j, double* c, Eigen::Index stride) {
  std::array<Lanes, N> sum;
  for (std::size_t q = 0; q < N; ++q) {
    sum[q] = Lanes::load_unaligned(c + static_cast<Eigen::Index>(q) * stride);
  }
  // A pointer, since there may be no row.
  const double* factor = factors.data() + j * factors.rows();
  for (Eigen::Index k = 0; k < factors.rows(); ++k) {
    const Lanes row = Lanes::load_unaligned(a + static_cast<Eigen::Index>(Lanes::kSize) * k);
    for (std::size_t q = 0; q < N; ++q) {
      sum[q] = fma(row, Lanes(factor[static_cast<Eigen::Index>(q) * factors.rows() + k]), sum[q]);
    }
  }
  for (std::size_t q = 0; q < N; ++q) {
    sum[q].store_unaligned(c + static_cast<Eigen::Index>(q) * stride);
  }
}

/// C += A B'. The number of rows of C must be a multiple of eight, that of columns a multiple of
/// two. Blocking does not change any sum: each is summed in the order of the columns of A.
inline void add_product(const ConstMatrix& A, const ConstMatrix& B, Part part,
                        Eigen::Ref<Eigen::MatrixXd> C) {
  constexpr Eigen::Index size = Lanes::kSize, blocks_together = 8;
  expect(C.rows() % size == 0 && C.cols() % 2 == 0, "rows are multiples of 8, columns of 2");
  const Eigen::MatrixXd factors = B.transpose();
  Eigen::MatrixXd panel(size, blocks_together * A.cols());  // rows of A, packed by eight
  for (Eigen::Index first = 0; first < C.rows(); first += blocks_together * size) {
    const Eigen::Index blocks = std::min(blocks_together, (C.rows() - first) / size);
    for (Eigen::Index b = 0; b < blocks; ++b) {
      panel.middleCols(b * A.cols(), A.cols()) = A.middleRows<size>(first + b * size);
    }
    for (Eigen::Index j = 0, width = 0; j < C.cols(); j += width) {
      width = C.cols() - j >= 4 ? 4 : 2;
      for (Eigen::Index b = 0; b < blocks; ++b) {
        const Eigen::Index row = first + b * size;
        if (part == Part::lower && row + size <= j) continue;
        const double* a = panel.data() + b * size * A.cols();
        if (width == 4) {
          add_block<4>(a, factors, j, &C(row, j), C.outerStride());
        } else {
          add_block<2>(a, factors, j, &C(row, j), C.outerStride());
        }
      }
    }
  }
}

/// A = L L' for a large symmetric matrix, block by block. Nearly all work is in add_product(),
/// which uses whole registers and gives the same bits on every processor.
class BlockedCholesky {
 public:
  /// Factorises A, given its lower triangle; returns false if A is not positive definite.
  [[nodiscard]] bool factorise(const ConstMatrix& A);

  /// Number of rows of A.
  Eigen::Index rows() const { return n_; }

  /// Replaces b by A^-1 b.
  void solve_in_place(Eigen::VectorXd& b) const;

  /// Writes A^-1 to P.
  void inverse(Eigen::Ref<Eigen::MatrixXd> P) const;

 private:
  Eigen::Index n_ = 0;
  Eigen::MatrixXd L_;  ///< above the blocks on the diagonal it still contains A
};

}  // namespace montecarta::filters
