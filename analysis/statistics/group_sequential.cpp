// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/group_sequential.hpp"

#include <boost/math/distributions/normal.hpp>

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {
namespace {

constexpr double kLeastSpent = 1e-10;  // a level nearer to 1 has no exact complement

}  // namespace

double spent(double alpha, double information) {
  if (!(information > 0.0)) return 0.0;
  const boost::math::normal normal;
  const double z = boost::math::quantile(boost::math::complement(normal, 0.5 * alpha));
  return 2.0 * boost::math::cdf(boost::math::complement(normal, z / std::sqrt(information)));
}

double level_of_look(double level, std::span<const std::uint64_t> looks, std::uint64_t runs) {
  if (looks.size() < 2) return level;
  const auto look = std::min(std::ranges::lower_bound(looks, runs), looks.end() - 1);
  const auto information = [&](std::uint64_t n) {
    return static_cast<double>(n) / static_cast<double>(looks.back());
  };
  const double before = look == looks.begin() ? 0.0 : spent(1.0 - level, information(*(look - 1)));
  return 1.0 - std::max(spent(1.0 - level, information(*look)) - before, kLeastSpent);
}

}  // namespace montecarta::analysis
