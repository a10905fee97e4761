// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/numbers/angle.hpp"
#include "engine/numbers/registers.hpp"

#include <limits>

/// Branch-free sine, cosine and arc tangent of one register. Those of xsimd choose their polynomial
/// by what the neighbouring lanes hold, so that a particle's bits would depend on who shares its
/// register, and its arc tangent divides four times where once is enough.
namespace montecarta::engine::register_math {

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

/// Angle of the vector (x, y) in [-pi, pi]; 0 where both are zero. One division: the octant is
/// chosen before it. Polynomial: Chebyshev fit of (atan(s)/s - 1)/s^2 in s^2 on [0, tan(pi/8)^2],
/// error 6e-18.
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

}  // namespace montecarta::engine::register_math
