// SPDX-License-Identifier: BSD-3-Clause
#include "filters/marginal/falling_exponential.hpp"

#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace montecarta {
namespace {

TEST(FallingExponential, EqualsTheLibrary) {
  RngStream draw({7, 0, 0, 0, Draw::test});
  for (int round = 0; round < 20000; ++round) {
    Lanes x(0.0);
    for (std::size_t i = 0; i < Lanes::kSize; ++i)
      set(x, i, round % 2 ? 708.0 * draw.uniform() : 2.0 * draw.uniform());
    const Lanes found = falling_exponential(x);
    for (std::size_t i = 0; i < Lanes::kSize; ++i) {
      const double expected = std::exp(-x.get(i));
      ASSERT_NEAR(found.get(i), expected, 7e-16 * expected) << x.get(i);
      ASSERT_EQ(found.get(i), falling_exponential(Lanes(x.get(i))).get(0));
    }
  }
}

TEST(FallingExponential, IsOneAtZeroAndZeroFarAway) {
  EXPECT_EQ(falling_exponential(Lanes(0.0)).get(0), 1.0);
  EXPECT_NEAR(falling_exponential(Lanes(-1e-12)).get(0), 1.0 + 1e-12, 1e-15);
  for (const double far : {708.0, 1e6, 1e300, std::numeric_limits<double>::infinity()})
    EXPECT_EQ(falling_exponential(Lanes(far)).get(3), 0.0) << far;
}

}  // namespace
}  // namespace montecarta
