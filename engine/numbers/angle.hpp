// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <cmath>
#include <numbers>

namespace montecarta::engine {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kTwoPi = 2.0 * std::numbers::pi;

/// The angle in (-pi, pi] that differs from `angle` [rad] by full turns; finite for any finite
/// angle, exactly idempotent, wrap(pi) = wrap(-pi) = pi.
inline double wrap(double angle) {
  if (angle > -kPi && angle <= kPi) return angle;
  const double wrapped = std::remainder(angle, kTwoPi);
  return wrapped <= -kPi ? kPi : (wrapped > kPi ? kPi : wrapped);
}

}  // namespace montecarta::engine
