// SPDX-License-Identifier: BSD-3-Clause
#include "engine/numbers/real.hpp"
#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace montecarta::engine {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Exponential, EqualsTheLibrary) {
  RngStream draw({7, 0, 0, 0, Draw::test});
  for (int round = 0; round < 20000; ++round) {
    Lanes x(0.0);
    for (std::size_t i = 0; i < Lanes::kSize; ++i)
      set(x, i, round % 2 ? 709.0 - 1417.0 * draw.uniform() : 1.0 - 2.0 * draw.uniform());
    const Lanes found = exp(x);
    for (std::size_t i = 0; i < Lanes::kSize; ++i) {
      const double expected = std::exp(x.get(i));
      ASSERT_NEAR(found.get(i), expected, 7e-16 * expected) << x.get(i);
    }
  }
}

TEST(Exponential, IsOneAtZeroAndZeroFarBelow) {
  EXPECT_EQ(exp(Lanes(0.0)).get(0), 1.0);
  EXPECT_NEAR(exp(Lanes(1e-12)).get(0), 1.0 + 1e-12, 1e-15);
  for (const double far : {-708.1, -1e6, -1e300, -kInfinity})
    EXPECT_EQ(exp(Lanes(far)).get(3), 0.0) << far;
  EXPECT_TRUE(std::isnan(exp(Lanes(std::numeric_limits<double>::quiet_NaN())).get(1)));
}

TEST(Logarithm, EqualsTheLibrary) {
  RngStream draw({8, 0, 0, 0, Draw::test});
  for (int round = 0; round < 20000; ++round) {
    Lanes x(0.0);
    for (std::size_t i = 0; i < Lanes::kSize; ++i) {
      const double u = draw.uniform();
      set(x, i, round % 3 == 0 ? u : round % 3 == 1 ? 0.9 + 0.2 * u : std::exp(1400.0 * (u - 0.5)));
    }
    const Lanes found = log(x);
    for (std::size_t i = 0; i < Lanes::kSize; ++i) {
      const double expected = std::log(x.get(i));
      ASSERT_NEAR(found.get(i), expected, 2.3e-16 * std::abs(expected)) << x.get(i);
    }
  }
}

TEST(Logarithm, OfZeroInfinityAndNegativeNumbers) {
  EXPECT_EQ(log(Lanes(1.0)).get(0), 0.0);
  EXPECT_EQ(log(Lanes(0.0)).get(0), -kInfinity);
  EXPECT_EQ(log(Lanes(1e-310)).get(0), -kInfinity) << "of less than full precision";
  EXPECT_EQ(log(Lanes(kInfinity)).get(0), kInfinity);
  EXPECT_NEAR(log(Lanes(std::numeric_limits<double>::min())).get(0), -708.3964185322641, 2e-13);
  EXPECT_TRUE(std::isnan(log(Lanes(-1.0)).get(0)));
  EXPECT_TRUE(std::isnan(log(Lanes(std::numeric_limits<double>::quiet_NaN())).get(0)));
}

}  // namespace
}  // namespace montecarta::engine
