// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/products.hpp"

#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace montecarta::filters {
namespace {

Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns, std::uint32_t seed) {
  RngStream draw({.seed = seed, .purpose = Draw::test});
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return draw.normal(); });
}

TEST(Products, ADotProductIsTheSum) {
  for (const Eigen::Index n : {0, 1, 7, 8, 15, 16, 17, 40, 1000}) {
    const Eigen::VectorXd a = random_matrix(n, 1, 1), b = random_matrix(n, 1, 2);
    double sum = 0.0;
    for (Eigen::Index i = 0; i < n; ++i) sum += a(i) * b(i);
    EXPECT_NEAR(dot(a, b), sum, 1e-15 * static_cast<double>(n) + 1e-16 * std::abs(sum)) << n;
  }
}

TEST(Products, ACombinationOfColumnsIsTheirSumInOrder) {
  for (const Eigen::Index k : {0, 1, 3, 4, 5, 9}) {
    const Eigen::MatrixXd A = random_matrix(37, k, 3);
    const Eigen::VectorXd b = random_matrix(k, 1, 4), start = random_matrix(37, 1, 5);
    Eigen::VectorXd found = start;
    add_combination(A, b, found);
    for (Eigen::Index i = 0; i < 37; ++i) {
      double sum = start(i);
      for (Eigen::Index j = 0; j < k; ++j) sum = std::fma(A(i, j), b(j), sum);
      EXPECT_EQ(found(i), sum) << "row " << i << " of " << k << " columns";
    }
  }
}

TEST(Products, AProductIsSummedInTheOrderOfTheColumns) {
  for (const Eigen::Index n : {8, 64, 72, 200}) {
    const Eigen::MatrixXd A = random_matrix(n, 13, 6), B = random_matrix(n, 13, 7);
    const Eigen::MatrixXd start = random_matrix(n, n, 8);
    Eigen::MatrixXd whole = start, lower = start;
    add_product(A, B, Part::whole, whole);
    add_product(A, B, Part::lower, lower);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j < n; ++j) {
        double sum = start(i, j);
        for (Eigen::Index k = 0; k < 13; ++k) sum = std::fma(A(i, k), B(j, k), sum);
        ASSERT_EQ(whole(i, j), sum) << i << ' ' << j << " of " << n;
        if (i >= j) {
          ASSERT_EQ(lower(i, j), sum) << i << ' ' << j << " of " << n;
        }
        if (i / 8 < j / 8 / 2) {
          ASSERT_EQ(lower(i, j), start(i, j)) << i << ' ' << j << " of " << n;
        }
      }
    }
  }
}

TEST(Products, AProductMayHaveFewColumns) {
  const Eigen::MatrixXd A = random_matrix(24, 5, 9), B = random_matrix(6, 5, 10);
  Eigen::MatrixXd found = Eigen::MatrixXd::Zero(24, 6);
  add_product(A, B, Part::whole, found);
  EXPECT_LT((found - A * B.transpose()).norm(), 1e-13);
}

/// Symmetric, positive definite, of n rows.
Eigen::MatrixXd some_information(Eigen::Index n) {
  RngStream draw({.seed = 5, .run = static_cast<std::uint64_t>(n), .purpose = Draw::world_control});
  Eigen::MatrixXd A(n, n);
  for (double& value : A.reshaped()) value = draw.normal();
  return A * A.transpose() + Eigen::MatrixXd::Identity(n, n);
}

// Less than a block, one, several, and sizes that fill no register.
TEST(BlockedCholesky, SolvesAndInvertsAsTheWholeFactorDoes) {
  for (const Eigen::Index n : {2, 30, 32, 70, 102}) {
    const Eigen::MatrixXd A = some_information(n);
    const Eigen::VectorXd b = A.row(0) + A.row(n - 1) * 0.5;
    BlockedCholesky factor;
    const Eigen::MatrixXd lower = A.triangularView<Eigen::Lower>();
    ASSERT_TRUE(factor.factorise(lower));
    EXPECT_EQ(factor.rows(), n);
    Eigen::MatrixXd P(n, n);
    factor.inverse(P);
    EXPECT_LT((P * A - Eigen::MatrixXd::Identity(n, n)).norm(), 1e-9) << n << " rows";
    EXPECT_TRUE(P.isApprox(P.transpose(), 0.0));
    Eigen::VectorXd x = b;
    factor.solve_in_place(x);
    EXPECT_LT((A * x - b).norm(), 1e-9 * b.norm()) << n << " rows";
  }
}

TEST(BlockedCholesky, SaysThatAMatrixIsNotPositiveDefinite) {
  Eigen::MatrixXd A = some_information(70);
  A(60, 60) = -1.0;
  EXPECT_FALSE(BlockedCholesky().factorise(A));
}

}  // namespace
}  // namespace montecarta::filters
