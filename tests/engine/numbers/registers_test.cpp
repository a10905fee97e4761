// SPDX-License-Identifier: BSD-3-Clause
// What a number becomes does not depend on how many others share its register.
#include "engine/numbers/real.hpp"
#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace montecarta::engine {
namespace {

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

/// Numbers at which instruction sets may differ: zeros, what does not count, what hardly counts,
/// halves between whole numbers.
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

TEST(Lanes, HaveTheSignThatDoubleHas) {
  for (const double a : corners()) EXPECT_EQ(bits((-Lanes(a)).get(0)), bits(-a)) << a;
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
