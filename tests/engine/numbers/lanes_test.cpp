// SPDX-License-Identifier: BSD-3-Clause
#include "engine/numbers/real.hpp"
#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace montecarta::engine {
namespace {

constexpr double kUlp = 2.3e-16;

/// Calls check(lanes, lane, number) for many random numbers in [-scale, scale].
template <class Check>
void for_random_lanes(double scale, Check check) {
  RngStream draw({7, 0, 0, 0, Draw::test});
  for (int round = 0; round < 20000; ++round) {
    Lanes lanes(0.0);
    for (std::size_t i = 0; i < Lanes::kSize; ++i)
      set(lanes, i, scale * (2.0 * draw.uniform() - 1.0));
    check(lanes);
  }
}

[[gnu::noipa]] double difference_of_products(double a, double b, double c, double d) {
  return a * b - c * d;
}
[[gnu::noipa]] Lanes difference_of_products(const Lanes& a, const Lanes& b, const Lanes& c,
                                            const Lanes& d) {
  return a * b - c * d;
}

// What is fused with what would depend on what is inlined where: one formula, two last bits.
TEST(Arithmetic, RoundsEveryOperationByItself) {
  const double a = 1.0 + 0x1p-30;
  EXPECT_EQ(difference_of_products(a, a, a, a), 0.0);
  EXPECT_EQ(difference_of_products(Lanes(a), Lanes(a), Lanes(a), Lanes(a)).get(0), 0.0);
}

TEST(Arithmetic, FusesWhereItIsToldTo) {
  const double a = 1.0 + 0x1p-30, square = 1.0 + 0x1p-29;
  EXPECT_EQ(fma(a, a, -square), 0x1p-60);
  EXPECT_EQ(fma(Lanes(a), Lanes(a), Lanes(-square)).get(0), 0x1p-60);
}

TEST(Lanes, LeastGreatestAndFloorEqualScalars) {
  for_random_lanes(20.0, [](const Lanes& a) {
    const Lanes b(a.get(3));
    const Lanes least = min(a, b), greatest = max(a, b), whole = floor(a);
    for (std::size_t i = 0; i < Lanes::kSize; ++i) {
      ASSERT_EQ(least.get(i), std::min(a.get(i), b.get(i)));
      ASSERT_EQ(greatest.get(i), std::max(a.get(i), b.get(i)));
      ASSERT_EQ(whole.get(i), std::floor(a.get(i)));
    }
  });
}

TEST(Lanes, SineAndCosineEqualTheLibrary) {
  for_random_lanes(20.0, [](const Lanes& angle) {
    const auto [cosine, sine] = direction_of(angle);
    for (std::size_t i = 0; i < Lanes::kSize; ++i) {
      ASSERT_NEAR(sine.get(i), std::sin(angle.get(i)), kUlp) << angle.get(i);
      ASSERT_NEAR(cosine.get(i), std::cos(angle.get(i)), kUlp) << angle.get(i);
    }
  });
}

TEST(Lanes, ArcTangentEqualsTheLibraryInEveryQuadrant) {
  for_random_lanes(1.0, [](const Lanes& y) {
    Lanes x(0.0);
    for (std::size_t i = 0; i < Lanes::kSize; ++i)
      set(x, i, y.get((i + 1) % 8) * (i % 2 ? 1e3 : 1.0));
    const Lanes angle = atan2(y, x);
    for (std::size_t i = 0; i < Lanes::kSize; ++i) {
      ASSERT_NEAR(angle.get(i), std::atan2(y.get(i), x.get(i)), 2 * kUlp * 2)
          << y.get(i) << ' ' << x.get(i);
    }
  });
}

TEST(Lanes, ArcTangentOnTheAxes) {
  const double cases[][2] = {{0, 1}, {0, -1}, {1, 0}, {-1, 0}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}};
  for (const auto& [y, x] : cases)
    EXPECT_NEAR(atan2(Lanes(y), Lanes(x)).get(0), std::atan2(y, x), kUlp);
}

TEST(Lanes, ArcTangentOfNothingIsZeroAsInTheLibrary) {
  EXPECT_EQ(atan2(Lanes(0.0), Lanes(0.0)).get(0), 0.0);
}

TEST(Lanes, WrapKeepsItsContractAtTheBorder) {
  for (double angle :
       {kPi, -kPi, std::nextafter(kPi, 4.0), std::nextafter(-kPi, -4.0), 3 * kPi, 1e300}) {
    const Lanes wrapped = wrap(Lanes(angle));
    EXPECT_GT(wrapped.get(0), -kPi) << angle;
    EXPECT_LE(wrapped.get(0), kPi) << angle;
    EXPECT_EQ(wrap(wrapped).get(0), wrapped.get(0)) << angle;
  }
  EXPECT_EQ(wrap(Lanes(-kPi)).get(0), kPi);
}

TEST(Lanes, WrapEqualsTheScalarOne) {
  for_random_lanes(30.0, [](const Lanes& angle) {
    const Lanes wrapped = wrap(angle);
    for (std::size_t i = 0; i < Lanes::kSize; ++i) {
      ASSERT_NEAR(wrap(wrapped.get(i) - wrap(angle.get(i))), 0.0, 1e-14);
      ASSERT_LE(std::abs(wrapped.get(i)), kPi + 1e-14);
    }
  });
}

TEST(Lanes, TheShorterWayIsTheSameAngleWithinHalfATurn) {
  for_random_lanes(30.0, [](const Lanes& angle) {
    const Lanes way = shorter_way(angle);
    for (std::size_t i = 0; i < Lanes::kSize; ++i) {
      ASSERT_NEAR(wrap(way.get(i) - wrap(angle.get(i))), 0.0, 1e-14);
      ASSERT_NEAR(way.get(i), shorter_way(angle.get(i)), 1e-14);
      ASSERT_LE(std::abs(way.get(i)), kPi + 1e-14);
    }
  });
}

TEST(Lanes, EveryLaneIsAFunctionOfItselfAlone) {
  for_random_lanes(10.0, [](const Lanes& a) {
    for (std::size_t i = 0; i < Lanes::kSize; ++i) {
      const Lanes alone(a.get(i));
      ASSERT_EQ(sin(a).get(i), sin(alone).get(0));
      ASSERT_EQ(atan2(a, Lanes(3.0)).get(i), atan2(alone, Lanes(3.0)).get(0));
      ASSERT_EQ(exp(a).get(i), exp(alone).get(0));
      ASSERT_EQ(log(a * a).get(i), log(alone * alone).get(0));
    }
  });
}

TEST(Lanes, SelectTakesLaneByLane) {
  Lanes a(0.0);
  for (std::size_t i = 0; i < Lanes::kSize; ++i) set(a, i, static_cast<double>(i));
  const Lanes chosen = select(a < Lanes(3.0), Lanes(-1.0), a);
  for (std::size_t i = 0; i < Lanes::kSize; ++i) {
    EXPECT_EQ(chosen.get(i), i < 3 ? -1.0 : static_cast<double>(i));
  }
}

TEST(Wrap, KeepsItsContract) {
  EXPECT_EQ(wrap(kPi), kPi);
  EXPECT_EQ(wrap(-kPi), kPi);
  for (double angle : {0.0, 3.2, -3.2, 1e3, -1e6, 1e18, 3 * kPi}) {
    EXPECT_EQ(wrap(wrap(angle)), wrap(angle)) << angle;
    EXPECT_GT(wrap(angle), -kPi);
    EXPECT_LE(wrap(angle), kPi);
  }
}

}  // namespace
}  // namespace montecarta::engine
