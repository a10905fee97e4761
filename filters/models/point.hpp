// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

namespace montecarta::models {

/// A place in the map frame; `Real` is double or Lanes.
template <class Real>
struct BasicPoint {
  Real x{};  ///< [m]
  Real y{};  ///< [m]

  [[gnu::always_inline]] friend BasicPoint operator+(const BasicPoint& a, const BasicPoint& b) {
    return {a.x + b.x, a.y + b.y};
  }
  [[gnu::always_inline]] friend BasicPoint operator-(const BasicPoint& a, const BasicPoint& b) {
    return {a.x - b.x, a.y - b.y};
  }
};
using Point = BasicPoint<double>;

}  // namespace montecarta::models
