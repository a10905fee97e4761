// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/numbers/angle.hpp"

#include <xsimd/xsimd.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

/// Arithmetic of one register of doubles of any width. It replaces functions of xsimd that differ
/// between instruction sets.
namespace montecarta::engine::register_math {

// The tests also build for registers of two doubles, which must give the same bits as wider ones.
#ifdef MONTECARTA_NARROW_REGISTERS
using Register = xsimd::batch<double, xsimd::sse4_2>;
#else
using Register = xsimd::batch<double>;
#endif

/// The bits of a register of doubles, as whole numbers.
template <class R>
using BitsOf = xsimd::batch<std::uint64_t, typename R::arch_type>;

// xsimd 8 rounds fma() twice on AVX-512 and on plain SSE, and fnma() on ARM. The names differ from
// those of xsimd, which argument-dependent look-up would prefer.

/// Returns a b + c, rounded once.
template <class R>
[[gnu::always_inline]] inline R multiply_add(const R& a, const R& b, const R& c) {
#ifdef __AVX512F__
  if constexpr (R::size == 8) return R(_mm512_fmadd_pd(a.data, b.data, c.data));
#endif
#ifdef __FMA__
  if constexpr (R::size == 2) return R(_mm_fmadd_pd(a.data, b.data, c.data));
#endif
  return xsimd::fma(a, b, c);
}

/// Returns c - a b, rounded once.
template <class R>
[[gnu::always_inline]] inline R negative_multiply_add(const R& a, const R& b, const R& c) {
#ifdef __AVX512F__
  if constexpr (R::size == 8) return R(_mm512_fnmadd_pd(a.data, b.data, c.data));
#endif
#ifdef __FMA__
  if constexpr (R::size == 2) return R(_mm_fnmadd_pd(a.data, b.data, c.data));
#endif
#ifdef __aarch64__
  if constexpr (R::size == 2) return R(vfmsq_f64(c.data, a.data, b.data));
#endif
  return xsimd::fnma(a, b, c);
}

/// Returns -x, also for zeros: xsimd 8 computes 0 - x on AVX-512.
template <class R>
[[gnu::always_inline]] inline R negative(const R& x) {
  return x ^ R(-0.0);
}

/// These functions return the lesser and the greater; b if one is NaN or both are zero. The
/// instructions of ARM return NaN.
template <class R>
[[gnu::always_inline]] inline R lesser(const R& a, const R& b) {
#ifdef __aarch64__
  return xsimd::select(a < b, a, b);
#else
  return xsimd::min(a, b);
#endif
}
template <class R>
[[gnu::always_inline]] inline R greater(const R& a, const R& b) {
#ifdef __aarch64__
  return xsimd::select(a > b, a, b);
#else
  return xsimd::max(a, b);
#endif
}

/// The greatest whole number that is not above x; -0 for -0, for which xsimd returns 0 on ARM.
template <class R>
[[gnu::always_inline]] inline R rounded_down(const R& x) {
#ifdef __aarch64__
  if constexpr (R::size == 2) return R(vrndmq_f64(x.data));
#endif
  return xsimd::floor(x);
}

/// The exact product of the low half of every lane with `b`. xsimd multiplies whole 64-bit lanes,
/// which takes three times as long.
template <class B>
[[gnu::always_inline]] inline B multiply_low_halves(const B& a, std::uint32_t b) {
#ifdef __AVX512F__
  if constexpr (B::size == 8) return B(_mm512_mul_epu32(a.data, _mm512_set1_epi64(b)));
#endif
#ifdef __AVX2__
  if constexpr (B::size == 4) return B(_mm256_mul_epu32(a.data, _mm256_set1_epi64x(b)));
#endif
#ifdef __SSE2__
  if constexpr (B::size == 2) return B(_mm_mul_epu32(a.data, _mm_set1_epi64x(b)));
#endif
#ifdef __aarch64__
  if constexpr (B::size == 2) return B(vmull_n_u32(vmovn_u64(a.data), b));
#endif
  return (a & B(std::uint64_t{0xffffffffU})) * B(std::uint64_t{b});
}

/// Adding this to |x| < 2^51 rounds x to the nearest whole number, which is then in the low bits.
template <class R>
[[gnu::always_inline]] inline R rounding_shift() {
  return R(0x1.8p52);
}

/// Polynomial with the highest coefficient first, evaluated as one in z^2 with pairs of
/// coefficients (Estrin), which halves the number of dependent steps.
template <class R, std::size_t N>
[[gnu::always_inline]] inline R polynomial(const R& z, const std::array<R, N>& coefficients) {
  if constexpr (N == 1) {
    return coefficients[0];
  } else {
    std::array<R, (N + 1) / 2> pairs;
    pairs[0] = coefficients[0];
    for (std::size_t k = N % 2; k < N; k += 2) {
      pairs[(k + 1) / 2] = multiply_add(coefficients[k], z, coefficients[k + 1]);
    }
    return polynomial(z * z, pairs);
  }
}
template <class R, class... Coefficients>
[[gnu::always_inline]] inline R polynomial(const R& z, double first, Coefficients... rest) {
  return polynomial(z, std::array<R, 1 + sizeof...(rest)>{R(first), R(rest)...});
}

// Branch-free sine, cosine and arc tangent of one register. Those of xsimd choose their polynomial
// by the values in all lanes, so that the bits of a particle would depend on its neighbours, and
// its arc tangent divides four times instead of once.

/// Sine and cosine for |angle| < 1e5, to one unit in the last place (polynomials of FreeBSD's
/// msun).
template <class R>
[[gnu::always_inline]] inline void sincos(const R& angle, R& sine, R& cosine) {
  using Bits = BitsOf<R>;
  const R shifted = multiply_add(angle, R(2.0 / kPi), rounding_shift<R>());
  const R quarters = shifted - rounding_shift<R>();
  R r = negative_multiply_add(quarters, R(1.57079632679489655800e+00), angle);
  r = negative_multiply_add(quarters, R(6.12323399573676603587e-17), r);
  const R z = r * r;
  const R s = multiply_add(r * z,
                           polynomial(z, 1.58969099521155010221e-10, -2.50507602534068634195e-08,
                                      2.75573137070700676789e-06, -1.98412698298579493134e-04,
                                      8.33333333332248946124e-03, -1.66666666666666324348e-01),
                           r);
  const R c = multiply_add(z * z,
                           polynomial(z, -1.13596475577881948265e-11, 2.08757232129817482790e-09,
                                      -2.75573143513906633035e-07, 2.48015872894767294178e-05,
                                      -1.38888888888741095749e-03, 4.16666666666666019037e-02),
                           negative_multiply_add(R(0.5), z, R(1.0)));
  const Bits quadrant = xsimd::bitwise_cast<Bits>(shifted);
  const R odd =
      xsimd::bitwise_cast<R>(Bits(std::uint64_t{0}) - (quadrant & Bits(std::uint64_t{1})));
  const R swap = (s ^ c) & odd;
  const R sine_sign = xsimd::bitwise_cast<R>((quadrant & Bits(std::uint64_t{2})) << 62);
  const R cosine_sign =
      xsimd::bitwise_cast<R>(((quadrant + Bits(std::uint64_t{1})) & Bits(std::uint64_t{2})) << 62);
  sine = s ^ swap ^ sine_sign;
  cosine = c ^ swap ^ cosine_sign;
}

/// Angle of the vector (x, y) in [-pi, pi]; 0 if both are zero. The octant is chosen first, so that
/// one division is enough. Polynomial: Chebyshev fit of (atan(s)/s - 1)/s^2 in s^2 on [0,
/// tan(pi/8)^2], error 6e-18.
template <class R>
[[gnu::always_inline]] inline R atan2(const R& y, const R& x) {
  const R ax = xsimd::abs(x), ay = xsimd::abs(y);
  const R big = greater(ax, ay), small = lesser(ax, ay);
  const auto steep = ay > ax;
  const auto middle = small > R(0.41421356237309503) * big;
  const R numerator = xsimd::select(middle, small - big, small);
  const R denominator =
      greater(xsimd::select(middle, small + big, big), R(std::numeric_limits<double>::min()));
  const R t = numerator / denominator;
  const R z = t * t;
  const R p = polynomial(z, -0.01917392228554793, 0.03922923713835943, -0.05085365922344248,
                         0.05858132894427922, -0.06664509603255386, 0.07692183059894114,
                         -0.09090904572487347, 0.11111111015117626, -0.1428571428466482,
                         0.19999999999995513, -0.3333333333333333);
  R angle = multiply_add(t * z, p, t);
  angle = angle + xsimd::select(middle, R(kPi / 4), R(0.0));
  angle = xsimd::select(steep, R(kPi / 2) - angle, angle);
  angle = xsimd::select(x < R(0.0), R(kPi) - angle, angle);
  return angle ^ (y & R(-0.0));
}

// Exponential and logarithm of one register. Those of xsimd 8 convert whole numbers through memory
// on AVX2, which has no instruction for it, and branch by the values in all lanes.

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

/// Natural logarithm, to one unit in the last place (polynomials of FreeBSD's msun); -infinity for
/// zero and for less than 2^-1022, NaN for negative numbers.
template <class R>
[[gnu::always_inline]] inline R log(const R& x) {
  using Bits = BitsOf<R>;
  // x = 2^k m with m in [sqrt(1/2), sqrt(2)).
  constexpr std::uint64_t kRootOfHalf = 0x3fe6a09e667f3bcd, kOne = 0x3ff0000000000000;
  const Bits above = xsimd::bitwise_cast<Bits>(x) + Bits(kOne - kRootOfHalf);
  const Bits exponent = above >> 52;
  const Bits m_bits = (above & Bits(std::uint64_t{0x000fffffffffffff})) + Bits(kRootOfHalf);
  // A whole number in the low bits of 2^52 represents 2^52 plus that number.
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
  const R positive = xsimd::select(x < R(kInfinity), finite, x);  // keeps infinity and NaN
  const R signless =
      xsimd::select(x < R(std::numeric_limits<double>::min()), R(-kInfinity), positive);
  return xsimd::select(x < R(0.0), R(std::numeric_limits<double>::quiet_NaN()), signless);
}

}  // namespace montecarta::engine::register_math
