// SPDX-License-Identifier: BSD-3-Clause
#include "engine/random/normals.hpp"

#include <boost/math/special_functions/erf.hpp>

#include <algorithm>
#include <numbers>

namespace montecarta::engine {

double normal_quantile(double probability) {
  constexpr double kMost = 1.0 - 0x1p-53;  // the number before 1, to which shares may round
  return -std::numbers::sqrt2 * boost::math::erfc_inv(2.0 * std::min(probability, kMost));
}

double normal_tails(double deviations) {
  return boost::math::erfc(deviations / std::numbers::sqrt2);
}

}  // namespace montecarta::engine
