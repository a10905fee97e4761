// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/figures/ellipse.hpp"

#include "engine/numbers/angle.hpp"

#include <cmath>

namespace montecarta::analysis {

Ellipse two_sigma_ellipse(double x, double y, double xx, double xy, double yy) {
  const double middle = 0.5 * (xx + yy);
  const double half_spread = std::hypot(0.5 * (xx - yy), xy);
  const double angle = 0.5 * std::atan2(2.0 * xy, xx - yy);
  const auto diameter = [](double variance) { return 4.0 * std::sqrt(variance); };
  return {x, y, diameter(middle + half_spread), diameter(middle - half_spread),
          angle * 180.0 / kPi};
}

}  // namespace montecarta::analysis
