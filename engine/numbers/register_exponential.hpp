// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/numbers/registers.hpp"

#include <cstdint>
#include <limits>

/// Exponential and logarithm of one register. Those of xsimd 8 convert whole numbers through memory
/// on AVX2, which has no instruction for it, and look at all lanes to choose their way.
namespace montecarta::engine::register_math {

/// ln 2 in two parts: a whole number below 2^20 times the first is exact.
inline constexpr double kLn2High = 6.93147180369123816490e-01;
inline constexpr double kLn2Low = 1.90821492927058770002e-10;

/// e^x for x <= 709, to 3 units in the last place; 0 below -708. Taylor's polynomial of degree 12
/// on [-ln 2 / 2, ln 2 / 2], relative error 2e-16.
template <class R>
[[gnu::always_inline]] inline R exp(const R& x) {
  using Bits = BitsOf<R>;
  const R shifted = multiply_add(x, R(1.4426950408889634074), rounding_shift<R>());  // x / ln 2
  const R twos = shifted - rounding_shift<R>();
  R r = negative_multiply_add(twos, R(kLn2High), x);
  r = negative_multiply_add(twos, R(kLn2Low), r);
  const R p =
      polynomial(r, 1.0 / 479001600, 1.0 / 39916800, 1.0 / 3628800, 1.0 / 362880, 1.0 / 40320,
                 1.0 / 5040, 1.0 / 720, 1.0 / 120, 1.0 / 24, 1.0 / 6, 0.5, 1.0, 1.0);
  const Bits scaled = xsimd::bitwise_cast<Bits>(p) + (xsimd::bitwise_cast<Bits>(shifted) << 52);
  return xsimd::select(x < R(-708.0), R(0.0), xsimd::bitwise_cast<R>(scaled));
}

/// Natural logarithm, to one unit in the last place (polynomials of FreeBSD's msun); -infinity of
/// zero and of less than 2^-1022, not a number of negative numbers.
template <class R>
[[gnu::always_inline]] inline R log(const R& x) {
  using Bits = BitsOf<R>;
  // x = 2^k m with m in [sqrt(1/2), sqrt(2)).
  constexpr std::uint64_t kRootOfHalf = 0x3fe6a09e667f3bcd, kOne = 0x3ff0000000000000;
  const Bits above = xsimd::bitwise_cast<Bits>(x) + Bits(kOne - kRootOfHalf);
  const Bits exponent = above >> 52;
  const Bits m_bits = (above & Bits(std::uint64_t{0x000fffffffffffff})) + Bits(kRootOfHalf);
  // A whole number in the low bits of 2^52 is that number, with 2^52 added.
  const R k = xsimd::bitwise_cast<R>(exponent | Bits(std::uint64_t{0x4330000000000000})) -
              R(0x1p52 + 1023.0);
  const R f = xsimd::bitwise_cast<R>(m_bits) - R(1.0);
  const R s = f / (f + R(2.0));
  const R z = s * s;
  const R tail =
      z * polynomial(z, 1.479819860511658591e-01, 1.531383769920937332e-01,
                     1.818357216161805012e-01, 2.222219843214978396e-01, 2.857142874366239149e-01,
                     3.999999999940941908e-01, 6.666666666666735130e-01);
  const R half_square = R(0.5) * f * f;
  const R low = multiply_add(s, half_square + tail, k * R(kLn2Low));
  const R finite = multiply_add(k, R(kLn2High), f - (half_square - low));
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const R positive = xsimd::select(x < R(kInfinity), finite, x);  // infinity, and not a number
  const R signless =
      xsimd::select(x < R(std::numeric_limits<double>::min()), R(-kInfinity), positive);
  return xsimd::select(x < R(0.0), R(std::numeric_limits<double>::quiet_NaN()), signless);
}

}  // namespace montecarta::engine::register_math
