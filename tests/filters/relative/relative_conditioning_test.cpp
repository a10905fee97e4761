// SPDX-License-Identifier: BSD-3-Clause
#include "filters/relative/relative_conditioning.hpp"

#include "tests/filters/relative/some_chain.hpp"

#include <gtest/gtest.h>

namespace montecarta::filters {
namespace {

/// The vehicle's pose in the frame of each landmark, and the coordinates of the landmark, put
/// together by some matrices.
Eigen::VectorXd measured(const RelativeChain& chain, const Eigen::VectorXd& x,
                         const LinearisedPairs& pairs) {
  VehicleInFrames vehicle;
  vehicle.linearise(chain, x, 0);
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(pairs.residual.size());
  for (const auto& [pair, frame, row, by_pose, by_point] : pairs.parts) {
    const Pose& pose = vehicle.in(frame);
    sums.segment<2>(2 * pair) +=
        by_pose * Eigen::Vector3d(pose.x, pose.y, pose.heading) + by_point * x.segment<2>(row);
  }
  return sums;
}

/// Two pairs, of which one is of two landmarks.
LinearisedPairs some_pairs() {
  Matrix23 A, B, C;
  A << 1.0, 2.0, -0.5, 0.3, -1.0, 2.0;
  B << 0.2, 0.7, 1.5, -0.4, 0.1, 0.9;
  C << -1.0, 0.5, 0.25, 0.6, 0.6, -2.0;
  LinearisedPairs pairs{.residual = Eigen::VectorXd::Zero(4), .parts = {}};
  pairs.parts = {{1, 2, 13, A, A.leftCols<2>()},
                 {0, 1, 3, B, B.leftCols<2>()},
                 {1, 0, 11, C, C.leftCols<2>()}};
  return pairs;
}

TEST(VehicleInFrames, ProductsAreThoseWithTheDifferenceQuotients) {
  const SomeChain some = some_chain(0.2);
  const LinearisedPairs pairs = some_pairs();
  Eigen::MatrixXd H(4, 16);
  for (Eigen::Index i = 0; i < 16; ++i) {
    const Eigen::VectorXd way = 1e-6 * Eigen::VectorXd::Unit(16, i);
    H.col(i) = (measured(some.chain, some.mean + way, pairs) -
                measured(some.chain, some.mean - way, pairs)) /
               2e-6;
  }
  VehicleInFrames vehicle;
  vehicle.linearise(some.chain, some.mean, 0);
  Eigen::MatrixXd PH;
  vehicle.columns(some.chain, some.P, pairs, PH);
  EXPECT_LT((PH - some.P * H.transpose()).norm(), 1e-8);
  EXPECT_LT((vehicle.rows(some.chain, pairs, PH) - H * PH).norm(), 1e-7);
}

}  // namespace
}  // namespace montecarta::filters
