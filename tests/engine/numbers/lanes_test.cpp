// SPDX-License-Identifier: BSD-3-Clause
#include "engine/numbers/real.hpp"
#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

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

// Fusing would depend on inlining, so that one formula would have two last bits.
TEST(Arithmetic, RoundsEveryOperationByItselfAndFusesWhereItIsToldTo) {
  const double a = 1.0 + 0x1p-30, square = 1.0 + 0x1p-29;
  EXPECT_EQ(difference_of_products(a, a, a, a), 0.0);
  EXPECT_EQ(difference_of_products(Lanes(a), Lanes(a), Lanes(a), Lanes(a)).get(0), 0.0);
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

/// A function of one number, that of the library, and where and how nearly they are the same.
struct LibraryFunction {
  const char* name;
  Lanes (*of_lanes)(const Lanes&);
  double (*of_library)(double);
  double (*place)(int round, double uniform);
  double relative, absolute;
  std::uint64_t seed = 7;
};

const LibraryFunction kLibrary[] = {
    {"sin", [](const Lanes& x) { return direction_of(x).sine; }, std::sin,
     [](int, double u) { return 40.0 * u - 20.0; }, 0.0, kUlp},
    {"cos", [](const Lanes& x) { return direction_of(x).cosine; }, std::cos,
     [](int, double u) { return 40.0 * u - 20.0; }, 0.0, kUlp},
    {"exp", [](const Lanes& x) { return exp(x); }, std::exp,
     [](int n, double u) { return n % 2 ? 709.0 - 1417.0 * u : 1.0 - 2.0 * u; }, 7e-16, 0.0},
    {"log", [](const Lanes& x) { return log(x); }, std::log,
     [](int n, double u) {
       return n % 3 == 0 ? u : n % 3 == 1 ? 0.9 + 0.2 * u : std::exp(1400.0 * (u - 0.5));
     },
     2.3e-16, 0.0, 8}};

TEST(Lanes, EqualTheLibrary) {
  for (const LibraryFunction& function : kLibrary) {
    RngStream draw({function.seed, 0, 0, 0, Draw::test});
    for (int round = 0; round < 20000; ++round) {
      Lanes x(0.0);
      for (std::size_t i = 0; i < Lanes::kSize; ++i) {
        set(x, i, function.place(round, draw.uniform()));
      }
      const Lanes found = function.of_lanes(x);
      for (std::size_t i = 0; i < Lanes::kSize; ++i) {
        const double expected = function.of_library(x.get(i));
        ASSERT_NEAR(found.get(i), expected,
                    function.absolute + function.relative * std::abs(expected))
            << function.name << " of " << x.get(i);
      }
    }
  }
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
  const double cases[][2] = {{0, 0}, {0, 1},  {0, -1}, {1, 0},  {-1, 0},
                             {1, 1}, {-1, 1}, {1, -1}, {-1, -1}};
  for (const auto& [y, x] : cases)
    EXPECT_NEAR(atan2(Lanes(y), Lanes(x)).get(0), std::atan2(y, x), kUlp);
}

TEST(Wrap, KeepsItsContractInLanesToo) {
  for (const double angle : {0.0, 3.2, -3.2, kPi, -kPi, std::nextafter(kPi, 4.0),
                             std::nextafter(-kPi, -4.0), 3 * kPi, 1e3, -1e6, 1e18, 1e300}) {
    for (const double wrapped : {wrap(angle), wrap(Lanes(angle)).get(0)}) {
      EXPECT_GT(wrapped, -kPi) << angle;
      EXPECT_LE(wrapped, kPi) << angle;
    }
    EXPECT_EQ(wrap(wrap(angle)), wrap(angle)) << angle;
    EXPECT_EQ(wrap(wrap(Lanes(angle))).get(0), wrap(Lanes(angle)).get(0)) << angle;
  }
  EXPECT_EQ(wrap(-kPi), kPi);
  EXPECT_EQ(wrap(Lanes(-kPi)).get(0), kPi);
}

TEST(Lanes, WrapAndShorterWayEqualTheScalarOnes) {
  for_random_lanes(30.0, [](const Lanes& angle) {
    const Lanes wrapped = wrap(angle), way = shorter_way(angle);
    for (std::size_t i = 0; i < Lanes::kSize; ++i) {
      ASSERT_NEAR(wrap(wrapped.get(i) - wrap(angle.get(i))), 0.0, 1e-14);
      ASSERT_LE(std::abs(wrapped.get(i)), kPi + 1e-14);
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

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Exponential, IsOneAtZeroAndZeroFarBelow) {
  EXPECT_EQ(exp(Lanes(0.0)).get(0), 1.0);
  EXPECT_NEAR(exp(Lanes(1e-12)).get(0), 1.0 + 1e-12, 1e-15);
  for (const double far : {-708.1, -1e6, -1e300, -kInfinity})
    EXPECT_EQ(exp(Lanes(far)).get(3), 0.0) << far;
  EXPECT_TRUE(std::isnan(exp(Lanes(std::numeric_limits<double>::quiet_NaN())).get(1)));
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

template <std::size_t N>
void expect_directions() {
  RngStream draw({.seed = N, .purpose = Draw::test});
  for (int n = 0; n < 200; ++n) {
    std::array<double, N> angles;
    for (double& angle : angles) angle = 20.0 * draw.normal();
    const auto found = directions_of(angles);
    for (std::size_t k = 0; k < N; ++k) {
      EXPECT_NEAR(found[k].cosine, std::cos(angles[k]), 3e-16) << k << " of " << N;
      EXPECT_NEAR(found[k].sine, std::sin(angles[k]), 3e-16) << k << " of " << N;
      EXPECT_EQ(found[k].sine, direction_of(Lanes(angles[k])).sine.get(0)) << "same as in a lane";
    }
  }
}

TEST(Directions, AreThoseOfEachAngleWhateverTheOthersAre) {
  expect_directions<1>();
  expect_directions<2>();
  expect_directions<4>();
  expect_directions<5>();
  expect_directions<8>();
}

// A result does not depend on how many other numbers share the register.

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }

template <class R>
class Registers : public testing::Test {};

#if defined(__AVX512F__)
using Widths = testing::Types<xsimd::batch<double, xsimd::sse4_2>,
                              xsimd::batch<double, xsimd::fma3<xsimd::avx2>>, xsimd::batch<double>>;
#elif defined(__AVX2__)
using Widths = testing::Types<xsimd::batch<double, xsimd::sse4_2>, xsimd::batch<double>>;
#else
using Widths = testing::Types<xsimd::batch<double>>;
#endif
TYPED_TEST_SUITE(Registers, Widths);

TYPED_TEST(Registers, HaveTheSameBitsAtEveryWidth) {
  RngStream draw({.seed = 11, .purpose = Draw::test});
  for (int n = 0; n < 20000; ++n) {
    const double x = 40.0 * draw.normal(), y = draw.normal(), z = draw.normal();
    const TypeParam wide(x), other(y), third(z);
    const Lanes lanes(x);
    TypeParam sine, cosine;
    register_math::sincos(wide, sine, cosine);
    ASSERT_EQ(bits(sine.get(0)), bits(sin(lanes).get(0))) << x;
    ASSERT_EQ(bits(cosine.get(0)), bits(cos(lanes).get(0))) << x;
    ASSERT_EQ(bits(register_math::atan2(wide, other).get(0)), bits(atan2(lanes, Lanes(y)).get(0)));
    ASSERT_EQ(bits(register_math::exp(wide).get(0)), bits(exp(lanes).get(0))) << x;
    ASSERT_EQ(bits(register_math::log(wide * wide).get(0)), bits(log(lanes * lanes).get(0))) << x;
    ASSERT_EQ(bits(register_math::multiply_add(wide, other, third).get(0)),
              bits(std::fma(x, y, z)));
    ASSERT_EQ(bits(register_math::negative_multiply_add(wide, other, third).get(0)),
              bits(std::fma(-x, y, z)));
  }
}

/// Numbers at which instruction sets may differ: zeros, denormal and tiny numbers, halves between
/// whole numbers.
std::vector<double> corners() {
  using Limits = std::numeric_limits<double>;
  std::vector<double> all = {
      0.0,    Limits::denorm_min(), 0.75 * Limits::min(), Limits::min(), 0.5, 1.0, 1.5, 2.5, 3e15,
      0x1p52, Limits::max(),        Limits::infinity()};
  for (std::size_t n = 0, count = all.size(); n < count; ++n) all.push_back(-all[n]);
  all.push_back(Limits::quiet_NaN());
  return all;
}

/// The second where neither is less.
double lesser(double a, double b) { return a < b ? a : b; }
double greater(double a, double b) { return a > b ? a : b; }

TYPED_TEST(Registers, TakeTheSignAndTheWholePartOfAnyNumber) {
  for (const double a : corners()) {
    const TypeParam x(a);
    EXPECT_EQ(bits((-Lanes(a)).get(0)), bits(-a)) << a;
    EXPECT_EQ(bits(register_math::negative(x).get(0)), bits(-a)) << a;
    EXPECT_EQ(bits(xsimd::abs(x).get(0)), bits(std::fabs(a))) << a;
    EXPECT_EQ(bits(register_math::rounded_down(x).get(0)), bits(std::floor(a))) << a;
    EXPECT_EQ(bits(xsimd::nearbyint(x).get(0)), bits(std::nearbyint(a))) << a;
    if (a >= 0.0) {
      EXPECT_EQ(bits(xsimd::sqrt(x).get(0)), bits(std::sqrt(a))) << a;
    }
  }
}

TYPED_TEST(Registers, CompareAndSelectAnyNumbers) {
  for (const double a : corners()) {
    for (const double b : corners()) {
      const std::string both = std::to_string(a) + " and " + std::to_string(b);
      const TypeParam x(a), y(b);
      EXPECT_EQ(bits(register_math::lesser(x, y).get(0)), bits(lesser(a, b))) << both;
      EXPECT_EQ(bits(register_math::greater(x, y).get(0)), bits(greater(a, b))) << both;
      EXPECT_EQ(bits(xsimd::select(x < y, x, y).get(0)), bits(a < b ? a : b)) << both;
      EXPECT_EQ(bits(xsimd::select(x <= y, x, y).get(0)), bits(a <= b ? a : b)) << both;
      EXPECT_EQ(bits(xsimd::select(x == y, x, y).get(0)), bits(a == b ? a : b)) << both;
    }
  }
}

TYPED_TEST(Registers, HaveTheSameBitsAtCorners) {
  for (const double a : corners()) {
    const TypeParam x(a);
    EXPECT_EQ(bits(register_math::log(x).get(0)), bits(log(Lanes(a)).get(0))) << a;
    if (std::fabs(a) <= 709.0 || a < 0.0) {
      EXPECT_EQ(bits(register_math::exp(x).get(0)), bits(exp(Lanes(a)).get(0))) << a;
    }
    for (const double b : corners()) {
      EXPECT_EQ(bits(register_math::atan2(x, TypeParam(b)).get(0)),
                bits(atan2(Lanes(a), Lanes(b)).get(0)))
          << a << " and " << b;
    }
  }
}

TYPED_TEST(Registers, MultiplyTheLowHalvesExactly) {
  using Bits = register_math::BitsOf<TypeParam>;
  for (const std::uint64_t a : {0x0ULL, 0x1ULL, 0xffffffffULL, 0x123456789abcdef0ULL}) {
    const std::uint64_t product = (a & 0xffffffffULL) * 0xd2511f53ULL;
    EXPECT_EQ(register_math::multiply_low_halves(Bits(a), 0xd2511f53U).get(0), product) << a;
  }
}

}  // namespace
}  // namespace montecarta::engine
