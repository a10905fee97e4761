// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/numbers/real.hpp"

#include <array>
#include <cstddef>

namespace montecarta::filters {

/// Where the members of an evolving population may be: centre +- half in every component, and which
/// components are angles [rad].
template <class Real, std::size_t D>
struct SearchBox {
  std::array<Real, D> centre;
  std::array<Real, D> half;  ///< >= 0
  std::array<bool, D> is_angle{};

  /// a - b of component j, wrapped if it is an angle.
  [[gnu::always_inline]] Real difference(std::size_t j, const Real& a, const Real& b) const {
    return is_angle[j] ? wrap(Real(a - b)) : Real(a - b);
  }
  /// `value` where it lies inside; otherwise reflected once at the wall it crossed, then clamped.
  [[gnu::always_inline]] Real repaired(std::size_t j, const Real& value) const {
    const Real out = difference(j, value, centre[j]);
    Real in = select(out > half[j], Real(half[j] + half[j] - out), out);
    in = select(out < -half[j], Real(-half[j] - half[j] - out), in);
    in = select(in > half[j], half[j], select(in < -half[j], Real(-half[j]), in));
    const Real inside = select(in == out, value, Real(centre[j] + in));
    return is_angle[j] ? wrap(inside) : inside;
  }
};

}  // namespace montecarta::filters
