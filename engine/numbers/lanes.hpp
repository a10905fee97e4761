// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/numbers/registers.hpp"

#include <array>
#include <cstddef>
#include <functional>
#include <type_traits>
#include <utility>

namespace montecarta::engine {

// Files that are compiled for different registers may be linked into one program (as in the Debian
// package): their lanes are different types, so that the linker takes no function for another.
#ifdef __AVX512F__
inline namespace avx512 {
#else
inline namespace narrower {
#endif

/// The lanes for which a condition holds.
struct LaneMask;

/// Eight doubles that are computed together, one for each of eight particles: the `Real` of
/// production. It is a value type with the arithmetic of double. Comparisons give a LaneMask, and
/// branches become select().
struct alignas(64) Lanes {
  using Register = register_math::Register;
  static constexpr std::size_t kSize = 8;
  static constexpr std::size_t kRegisters = kSize / Register::size;
  static_assert(kRegisters * Register::size == kSize);

  std::array<Register, kRegisters> part;

  Lanes() = default;
  // Copies register by register. The compiler would copy plain memory by halves of registers, and
  // reading a register back from two halves waits for memory (GCC 12: a fifth of FastSLAM II).
  [[gnu::always_inline]] Lanes(const Lanes& other) { *this = other; }
  [[gnu::always_inline]] Lanes& operator=(const Lanes& other) {
    for (std::size_t k = 0; k < kRegisters; ++k) part[k] = other.part[k];
    return *this;
  }
  ~Lanes() = default;
  Lanes(double value) { part.fill(Register(value)); }  // NOLINT: a number is the same in every lane

  /// Loads eight doubles from any address.
  [[gnu::always_inline]] static Lanes load_unaligned(const double* memory) {
    Lanes lanes;
    for (std::size_t k = 0; k < kRegisters; ++k) {
      lanes.part[k] = Register::load_unaligned(memory + k * Register::size);
    }
    return lanes;
  }
  /// Returns {number(0), ..., number(7)}, composed in registers. If stored one by one, numbers
  /// could not be loaded together before they reach the cache.
  template <class Function>
  [[gnu::always_inline]] static Lanes composed(const Function& number) {
    const auto compose = [&]<std::size_t... l>(std::size_t first, std::index_sequence<l...>) {
      return Register{number(first + l)...};
    };
    Lanes lanes;
    for (std::size_t k = 0; k < kRegisters; ++k) {
      lanes.part[k] = compose(k * Register::size, std::make_index_sequence<Register::size>());
    }
    return lanes;
  }
  void store(double* memory) const {
    for (std::size_t k = 0; k < kRegisters; ++k) part[k].store_aligned(memory + k * Register::size);
  }
  [[gnu::always_inline]] void store_unaligned(double* memory) const {
    for (std::size_t k = 0; k < kRegisters; ++k)
      part[k].store_unaligned(memory + k * Register::size);
  }
  double get(std::size_t lane) const {
    return part[lane / Register::size].get(lane % Register::size);
  }
};

struct LaneMask {
  using Register = Lanes::Register::batch_bool_type;
  std::array<Register, Lanes::kRegisters> part;
};

/// Applies `function` register by register.
template <class Function, class... Arguments>
[[gnu::always_inline]] inline auto by_register(const Function& function,
                                               const Arguments&... arguments) {
  using Register = decltype(function(arguments.part[0]...));
  using Result = std::conditional_t<std::is_same_v<Register, Lanes::Register>, Lanes, LaneMask>;
  Result result;
  for (std::size_t k = 0; k < Lanes::kRegisters; ++k)
    result.part[k] = function(arguments.part[k]...);
  return result;
}

[[gnu::always_inline]] inline Lanes operator+(const Lanes& a, const Lanes& b) {
  return by_register(std::plus<>(), a, b);
}
[[gnu::always_inline]] inline Lanes operator-(const Lanes& a, const Lanes& b) {
  return by_register(std::minus<>(), a, b);
}
[[gnu::always_inline]] inline Lanes operator*(const Lanes& a, const Lanes& b) {
  return by_register(std::multiplies<>(), a, b);
}
[[gnu::always_inline]] inline Lanes operator/(const Lanes& a, const Lanes& b) {
  return by_register(std::divides<>(), a, b);
}
[[gnu::always_inline]] inline LaneMask operator<(const Lanes& a, const Lanes& b) {
  return by_register(std::less<>(), a, b);
}
[[gnu::always_inline]] inline LaneMask operator<=(const Lanes& a, const Lanes& b) {
  return by_register(std::less_equal<>(), a, b);
}
[[gnu::always_inline]] inline LaneMask operator>(const Lanes& a, const Lanes& b) {
  return by_register(std::greater<>(), a, b);
}
[[gnu::always_inline]] inline LaneMask operator>=(const Lanes& a, const Lanes& b) {
  return by_register(std::greater_equal<>(), a, b);
}
[[gnu::always_inline]] inline LaneMask operator==(const Lanes& a, const Lanes& b) {
  return by_register(std::equal_to<>(), a, b);
}

inline Lanes operator-(const Lanes& a) {
  return by_register([](const auto& x) { return register_math::negative(x); }, a);
}
inline Lanes& operator+=(Lanes& a, const Lanes& b) { return a = a + b; }
inline Lanes& operator-=(Lanes& a, const Lanes& b) { return a = a - b; }
inline Lanes& operator*=(Lanes& a, const Lanes& b) { return a = a * b; }
inline LaneMask operator&&(const LaneMask& a, const LaneMask& b) {
  return by_register([](const auto& x, const auto& y) { return x && y; }, a, b);
}
inline LaneMask operator!(const LaneMask& a) {
  return by_register([](const auto& x) { return !x; }, a);
}
/// Returns a in the lanes of the mask, and b in the others.
[[gnu::always_inline]] inline Lanes select(const LaneMask& mask, const Lanes& a, const Lanes& b) {
  return by_register(
      [](const auto& m, const auto& x, const auto& y) { return xsimd::select(m, x, y); }, mask, a,
      b);
}
inline bool any(const LaneMask& mask) {
  bool found = false;
  for (const auto& part : mask.part) found = found || xsimd::any(part);
  return found;
}

}  // inline namespace

}  // namespace montecarta::engine
