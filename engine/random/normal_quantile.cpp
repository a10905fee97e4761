// SPDX-License-Identifier: BSD-3-Clause
#include "engine/random/normal_quantile.hpp"

#include <boost/math/special_functions/erf.hpp>

#include <numbers>

namespace montecarta {

double normal_quantile(double probability) {
  return -std::numbers::sqrt2 * boost::math::erfc_inv(2.0 * probability);
}

}  // namespace montecarta
