// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/drives/simulated_drive.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace montecarta::experiments {
namespace {

// Uniform over a disc: the mean of the squared distance is half of its greatest, here to 5 standard
// errors (its variance is 1/12 of the greatest, squared).
TEST(RandomMap, DisplacesEvenlyOverADisc) {
  const std::vector<Eigen::Vector2d> places(100, Eigen::Vector2d(3.0, -7.0));
  const RandomMap map(places, 4.0, 5);
  double squares = 0.0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (std::uint64_t run = 0; run < 20; ++run) {
    for (const Eigen::Vector2d& at : map(run)) {
      EXPECT_LE((at - places[0]).norm(), 4.0);
      squares += (at - places[0]).squaredNorm();
      sum += at - places[0];
    }
  }
  const double n = 2000.0;
  EXPECT_NEAR(squares / n, 8.0, 5.0 * 16.0 / std::sqrt(12.0 * n));
  EXPECT_LT((sum / n).norm(), 5.0 * std::sqrt(8.0 / n));
}

TEST(RandomMap, DiffersFromRunToRunAndFromSeedToSeed) {
  const RandomMap map({{0, 0}}, 1.0, 5), other({{0, 0}}, 1.0, 6);
  EXPECT_EQ(map(3), map(3));
  EXPECT_NE(map(3), map(4));
  EXPECT_NE(map(3), other(3));
}

}  // namespace
}  // namespace montecarta::experiments
