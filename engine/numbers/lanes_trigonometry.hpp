// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/numbers/angle.hpp"
#include "engine/numbers/lanes.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

/// Branch-free sine, cosine and arc tangent of one register. The library's choose their polynomial
/// by what the neighbouring lanes hold, so that a particle's bits would depend on who shares its
/// register, and its arc tangent divides four times where once is enough.
namespace montecarta::register_math {

using Register = Lanes::Register;
using Bits = xsimd::batch<std::int64_t>;

/// Polynomial with the highest coefficient first, as one in z^2 whose coefficients are pairs
/// (Estrin): half as many steps wait for each other.
template <std::size_t N>
[[gnu::always_inline]] inline Register polynomial(const Register& z,
                                                  const std::array<Register, N>& coefficients) {
  if constexpr (N == 1) {
    return coefficients[0];
  } else {
    std::array<Register, (N + 1) / 2> pairs;
    pairs[0] = coefficients[0];
    for (std::size_t k = N % 2; k < N; k += 2) {
      pairs[(k + 1) / 2] = xsimd::fma(coefficients[k], z, coefficients[k + 1]);
    }
    return polynomial(z * z, pairs);
  }
}
template <class... Coefficients>
[[gnu::always_inline]] inline Register polynomial(const Register& z, double first,
                                                  Coefficients... rest) {
  return polynomial(z,
                    std::array<Register, 1 + sizeof...(rest)>{Register(first), Register(rest)...});
}

/// Sine and cosine for |angle| < 1e5, to one unit in the last place (polynomials of FreeBSD's
/// msun).
[[gnu::always_inline]] inline void sincos(const Register& angle, Register& sine, Register& cosine) {
  const Register shift(0x1.8p52);  // adding it leaves the nearest integer in the low bits
  const Register shifted = xsimd::fma(angle, Register(2.0 / kPi), shift);
  const Register quarters = shifted - shift;
  Register r = xsimd::fnma(quarters, Register(1.57079632679489655800e+00), angle);
  r = xsimd::fnma(quarters, Register(6.12323399573676603587e-17), r);
  const Register z = r * r;
  const Register s =
      xsimd::fma(r * z,
                 polynomial(z, 1.58969099521155010221e-10, -2.50507602534068634195e-08,
                            2.75573137070700676789e-06, -1.98412698298579493134e-04,
                            8.33333333332248946124e-03, -1.66666666666666324348e-01),
                 r);
  const Register c =
      xsimd::fma(z * z,
                 polynomial(z, -1.13596475577881948265e-11, 2.08757232129817482790e-09,
                            -2.75573143513906633035e-07, 2.48015872894767294178e-05,
                            -1.38888888888741095749e-03, 4.16666666666666019037e-02),
                 xsimd::fnma(Register(0.5), z, Register(1.0)));
  const Bits quadrant = xsimd::bitwise_cast<Bits>(shifted);
  const Register odd = xsimd::bitwise_cast<Register>(Bits(0) - (quadrant & Bits(1)));
  const Register swap = (s ^ c) & odd;
  const Register sine_sign = xsimd::bitwise_cast<Register>((quadrant & Bits(2)) << 62);
  const Register cosine_sign =
      xsimd::bitwise_cast<Register>(((quadrant + Bits(1)) & Bits(2)) << 62);
  sine = s ^ swap ^ sine_sign;
  cosine = c ^ swap ^ cosine_sign;
}

/// Angle of the vector (x, y) in [-pi, pi]; 0 where both are zero. One division: the octant is
/// chosen before it. Polynomial: Chebyshev fit of (atan(s)/s - 1)/s^2 in s^2 on [0, tan(pi/8)^2],
/// error 6e-18.
[[gnu::always_inline]] inline Register atan2(const Register& y, const Register& x) {
  const Register ax = xsimd::abs(x), ay = xsimd::abs(y);
  const Register big = xsimd::max(ax, ay), small = xsimd::min(ax, ay);
  const auto steep = ay > ax;
  const auto middle = small > Register(0.41421356237309503) * big;
  const Register numerator = xsimd::select(middle, small - big, small);
  const Register denominator = xsimd::max(xsimd::select(middle, small + big, big),
                                          Register(std::numeric_limits<double>::min()));
  const Register t = numerator / denominator;
  const Register z = t * t;
  const Register p = polynomial(z, -0.01917392228554793, 0.03922923713835943, -0.05085365922344248,
                                0.05858132894427922, -0.06664509603255386, 0.07692183059894114,
                                -0.09090904572487347, 0.11111111015117626, -0.1428571428466482,
                                0.19999999999995513, -0.3333333333333333);
  Register angle = xsimd::fma(t * z, p, t);
  angle = angle + xsimd::select(middle, Register(kPi / 4), Register(0.0));
  angle = xsimd::select(steep, Register(kPi / 2) - angle, angle);
  angle = xsimd::select(x < Register(0.0), Register(kPi) - angle, angle);
  return angle ^ (y & Register(-0.0));
}

}  // namespace montecarta::register_math
