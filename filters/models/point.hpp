// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace montecarta {

/// A place in the map frame; `Real` is double or Lanes.
template <class Real>
struct BasicPoint {
  Real x{};  ///< [m]
  Real y{};  ///< [m]
};
using Point = BasicPoint<double>;

}  // namespace montecarta
