// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace montecarta {

/// The unit vector at an angle; `Real` is double or Lanes.
template <class Real>
struct Direction {
  Real cosine;
  Real sine;
};

/// The unit vector at `angle` [rad]. An overload for one `Real` may share work between the two.
template <class Real>
Direction<Real> direction_of(const Real& angle) {
  using std::cos;
  using std::sin;
  return {cos(angle), sin(angle)};
}

}  // namespace montecarta
