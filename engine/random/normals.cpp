// SPDX-License-Identifier: BSD-3-Clause
#include "engine/random/normals.hpp"

#include <boost/math/special_functions/erf.hpp>

#include <algorithm>
#include <numbers>

namespace montecarta::engine {
namespace {

/// In double, of which every processor has the same; long double is another format on each.
using InDouble = boost::math::policies::policy<boost::math::policies::promote_double<false>>;

}  // namespace

double normal_quantile(double probability) {
  constexpr double kMost = 1.0 - 0x1p-53;  // the number before 1, to which shares may round
  return -std::numbers::sqrt2 *
         boost::math::erfc_inv(2.0 * std::min(probability, kMost), InDouble());
}

double normal_tails(double deviations) {
  return boost::math::erfc(deviations / std::numbers::sqrt2, InDouble());
}

}  // namespace montecarta::engine
