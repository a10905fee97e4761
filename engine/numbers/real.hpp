// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/numbers/angle.hpp"
#include "engine/numbers/lanes.hpp"
#include "engine/numbers/registers.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>

/// The functions of per-particle arithmetic, for both `Real` = double and `Real` = Lanes. Every
/// lane is computed from that lane alone, so a result never depends on which particles share a
/// register.

namespace montecarta::engine {

template <class Real>
inline constexpr std::size_t kLanesOf = 1;
template <>
inline constexpr std::size_t kLanesOf<Lanes> = Lanes::kSize;

using std::atan2;
using std::cos;
using std::exp;
using std::floor;
using std::fma;
using std::log;
using std::sin;
using std::sqrt;

inline double select(bool mask, double a, double b) { return mask ? a : b; }
inline bool any(bool mask) { return mask; }

/// Returns number(lane) in every lane.
template <class Real, class Function>
[[gnu::always_inline]] inline Real composed(const Function& number) {
  if constexpr (std::is_same_v<Real, Lanes>) {
    return Lanes::composed(number);
  } else {
    return number(0);
  }
}
inline void store(double* memory, double value) { *memory = value; }
inline void store(double* memory, const Lanes& value) { value.store(memory); }

inline double get(double value, std::size_t) { return value; }
inline double get(const Lanes& value, std::size_t lane) { return value.get(lane); }
inline void set(double& value, std::size_t, double number) { value = number; }
inline void set(Lanes& value, std::size_t lane, double number) {
  reinterpret_cast<double*>(value.part.data())[lane] = number;
}

/// Returns sqrt(x^2 + y^2). The hypot() of C libraries rounds differently on different processors.
template <class Real>
Real length(const Real& x, const Real& y) {
  return sqrt(Real(x * x + y * y));
}

/// The sum over all lanes, in order.
template <class Real>
double sum_of_lanes(const Real& a) {
  double sum = get(a, 0);
  for (std::size_t lane = 1; lane < kLanesOf<Real>; ++lane) sum += get(a, lane);
  return sum;
}

/// The unit vector at an angle.
template <class Real>
struct Direction {
  Real cosine;
  Real sine;
};
/// The unit vector at `angle` [rad], |angle| < 1e5.
inline Direction<double> direction_of(double angle) { return {std::cos(angle), std::sin(angle)}; }
[[gnu::always_inline]] inline Direction<Lanes> direction_of(const Lanes& angle) {
  Direction<Lanes> result;
  for (std::size_t k = 0; k < Lanes::kRegisters; ++k) {
    register_math::sincos(angle.part[k], result.sine.part[k], result.cosine.part[k]);
  }
  return result;
}
[[gnu::always_inline]] inline Lanes atan2(const Lanes& y, const Lanes& x) {
  return by_register([](const auto& b, const auto& a) { return register_math::atan2(b, a); }, y, x);
}
inline Lanes sin(const Lanes& angle) { return direction_of(angle).sine; }
inline Lanes cos(const Lanes& angle) { return direction_of(angle).cosine; }
inline Lanes log(const Lanes& a) {
  return by_register([](const auto& x) { return register_math::log(x); }, a);
}

inline Lanes sqrt(const Lanes& a) {
  return by_register([](const auto& x) { return xsimd::sqrt(x); }, a);
}
/// Returns exp(a) for a <= 709.
inline Lanes exp(const Lanes& a) {
  return by_register([](const auto& x) { return register_math::exp(x); }, a);
}
/// Returns a b + c, rounded once.
[[gnu::always_inline]] inline Lanes fma(const Lanes& a, const Lanes& b, const Lanes& c) {
  return by_register([](const auto& x, const auto& y,
                        const auto& z) { return register_math::multiply_add(x, y, z); },
                     a, b, c);
}
inline Lanes max(const Lanes& a, const Lanes& b) {
  return by_register([](const auto& x, const auto& y) { return register_math::greater(x, y); }, a,
                     b);
}
inline double max(double a, double b) { return a < b ? b : a; }
inline Lanes min(const Lanes& a, const Lanes& b) {
  return by_register([](const auto& x, const auto& y) { return register_math::lesser(x, y); }, a,
                     b);
}
inline double min(double a, double b) { return b < a ? b : a; }
inline Lanes floor(const Lanes& a) {
  return by_register([](const auto& x) { return register_math::rounded_down(x); }, a);
}

/// `angle` [rad] minus the nearest whole number of turns, in [-pi, pi] up to rounding. It is for
/// differences that are used at once; angles that are kept must be wrapped by wrap().
inline double shorter_way(double angle) {
  return angle - kTwoPi * std::nearbyint(angle * (1.0 / kTwoPi));
}
[[gnu::always_inline]] inline Lanes shorter_way(const Lanes& angle) {
  return by_register(
      [](const auto& x) {
        using Register = Lanes::Register;
        return register_math::negative_multiply_add(xsimd::nearbyint(x * Register(1.0 / kTwoPi)),
                                                    Register(kTwoPi), x);
      },
      angle);
}

/// wrap(double) for lanes: the result is in (-pi, pi], and exact if the angle is in range already.
inline Lanes wrap(const Lanes& angle) {
  return by_register(
      [](const auto& x) {
        using Register = Lanes::Register;
        const Register turns = xsimd::nearbyint(x * Register(1.0 / kTwoPi));
        const Register wrapped = register_math::lesser(
            register_math::negative_multiply_add(turns, Register(kTwoPi), x), Register(kPi));
        return xsimd::select(wrapped > Register(-kPi), wrapped, Register(kPi));
      },
      angle);
}

/// The unit vectors at a few angles [rad], computed together at little more than the cost of one.
template <std::size_t N>
[[gnu::always_inline]] inline std::array<Direction<double>, N> directions_of(
    const std::array<double, N>& angles) {
  static_assert(N <= Lanes::kSize);
  constexpr std::size_t size = Lanes::Register::size;
  std::array<Direction<double>, N> directions;
  for (std::size_t first = 0; first < N; first += size) {
    Lanes::Register angle(0.0), sine, cosine;
    for (std::size_t k = first; k < N && k < first + size; ++k) angle.data[k - first] = angles[k];
    register_math::sincos(angle, sine, cosine);
    for (std::size_t k = first; k < N && k < first + size; ++k)
      directions[k] = {cosine.data[k - first], sine.data[k - first]};
  }
  return directions;
}

}  // namespace montecarta::engine
