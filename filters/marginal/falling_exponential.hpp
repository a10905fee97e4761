// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/numbers/real.hpp"

#include <cmath>

namespace montecarta {

inline double falling_exponential(double x) { return std::exp(-x); }

/// exp(-x) for x >= 0, to 3 units in the last place; 0 beyond 708. The library's exp divides, and
/// kernel sums spend half their time in it. Taylor's polynomial of degree 12 on [-ln 2 / 2, ln 2 /
/// 2], relative error 2e-16.
inline Lanes falling_exponential(const Lanes& x) {
  return by_register(
      [](const auto& argument) {
        using register_math::Bits;
        using register_math::Register;
        const Register shift(0x1.8p52);  // adding it leaves the nearest integer in the low bits
        const Register shifted =
            xsimd::fnma(argument, Register(1.4426950408889634074), shift);  // -x / ln 2
        const Register twos = shifted - shift;
        Register r = xsimd::fnma(twos, Register(6.93147180369123816490e-01), -argument);
        r = xsimd::fnma(twos, Register(1.90821492927058770002e-10), r);
        const Register p = register_math::polynomial(
            r, 1.0 / 479001600, 1.0 / 39916800, 1.0 / 3628800, 1.0 / 362880, 1.0 / 40320,
            1.0 / 5040, 1.0 / 720, 1.0 / 120, 1.0 / 24, 1.0 / 6, 0.5, 1.0, 1.0);
        const Bits scaled =
            xsimd::bitwise_cast<Bits>(p) + (xsimd::bitwise_cast<Bits>(shifted) << 52);
        return xsimd::select(argument < Register(708.0), xsimd::bitwise_cast<Register>(scaled),
                             Register(0.0));
      },
      x);
}

}  // namespace montecarta
