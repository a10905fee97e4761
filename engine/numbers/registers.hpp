// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <xsimd/xsimd.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

/// Arithmetic of one register of doubles of any width: what xsimd has, and where it differs from
/// one instruction set to another, in a form that does not.
namespace montecarta::engine::register_math {

// The tests also build for registers of two doubles, whose bits must be those of wider ones.
#ifdef MONTECARTA_NARROW_REGISTERS
using Register = xsimd::batch<double, xsimd::sse4_2>;
#else
using Register = xsimd::batch<double>;
#endif

/// The bits of a register of doubles, as whole numbers.
template <class R>
using BitsOf = xsimd::batch<std::uint64_t, typename R::arch_type>;

// xsimd 8 rounds fma() twice on AVX-512 and on plain SSE, fnma() on ARM. The names differ from
// those of xsimd, which argument-dependent look-up would prefer.

/// a b + c, rounded once.
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

/// c - a b, rounded once.
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

/// -x, of zeros too: that of xsimd 8 is 0 - x on AVX-512.
template <class R>
[[gnu::always_inline]] inline R negative(const R& x) {
  return x ^ R(-0.0);
}

/// The lesser and the greater; b where one is not a number, or both are zero. ARM's own give what
/// is not a number.
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

/// The greatest whole number that is not above x; -0 of -0, of which xsimd makes 0 on ARM.
template <class R>
[[gnu::always_inline]] inline R rounded_down(const R& x) {
#ifdef __aarch64__
  if constexpr (R::size == 2) return R(vrndmq_f64(x.data));
#endif
  return xsimd::floor(x);
}

/// The product of the low halves of all lanes with `b`, exactly. xsimd multiplies 64-bit lanes in
/// full, which takes three times as long.
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

/// Adding it to |x| < 2^51 rounds x to the nearest whole number, which then stands in the low bits.
template <class R>
[[gnu::always_inline]] inline R rounding_shift() {
  return R(0x1.8p52);
}

/// Polynomial with the highest coefficient first, as one in z^2 whose coefficients are pairs
/// (Estrin): half as many steps wait for each other.
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

}  // namespace montecarta::engine::register_math
