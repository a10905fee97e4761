// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/blocked_cholesky.hpp"

#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

namespace montecarta::filters {
namespace {

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
