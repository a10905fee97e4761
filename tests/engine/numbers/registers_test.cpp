// SPDX-License-Identifier: BSD-3-Clause
// What a number becomes does not depend on how many others share its register.
#include "engine/numbers/real.hpp"
#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>

namespace montecarta {
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

TYPED_TEST(Registers, MultiplyTheLowHalvesExactly) {
  using Bits = register_math::BitsOf<TypeParam>;
  for (const std::uint64_t a : {0x0ULL, 0x1ULL, 0xffffffffULL, 0x123456789abcdef0ULL}) {
    const std::uint64_t product = (a & 0xffffffffULL) * 0xd2511f53ULL;
    EXPECT_EQ(register_math::multiply_low_halves(Bits(a), 0xd2511f53U).get(0), product) << a;
  }
}

}  // namespace
}  // namespace montecarta
