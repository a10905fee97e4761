// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/weighted_squares.hpp"

#include <boost/math/distributions/normal.hpp>

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {
namespace {

constexpr int kHalvings = 60;
constexpr double kAtTheMean = 1e-4;  // deviates below which the formula loses its digits

/// Derivatives of the cumulant generating function at `t`.
struct Cumulants {
  double value = 0.0, first = 0.0, second = 0.0, third = 0.0;
};

Cumulants cumulants_at(std::span<const WeightedSquares> terms, double t) {
  Cumulants sums;
  for (const auto& [weight, count] : terms) {
    const double scaled = weight / (1.0 - 2.0 * t * weight);
    sums.value -= 0.5 * count * std::log1p(-2.0 * t * weight);
    sums.first += count * scaled;
    sums.second += 2.0 * count * scaled * scaled;
    sums.third += 8.0 * count * scaled * scaled * scaled;
  }
  return sums;
}

/// Where the first derivative, which increases, is `x`.
double saddlepoint(std::span<const WeightedSquares> terms, double x) {
  const double mean = cumulants_at(terms, 0.0).first;
  double below = 0.0, above = 0.0;
  if (x < mean) {
    below = -1.0 / mean;
    while (cumulants_at(terms, below).first > x) below *= 2.0;
  } else {
    above = 0.5 * (1.0 - 1e-12) / std::ranges::max(terms, {}, &WeightedSquares::weight).weight;
  }
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (below + above);
    (cumulants_at(terms, middle).first < x ? below : above) = middle;
  }
  return 0.5 * (below + above);
}

}  // namespace

double probability_below(std::span<const WeightedSquares> terms, double x) {
  if (!(x > 0.0)) return 0.0;
  const double t = saddlepoint(terms, x);
  const Cumulants at = cumulants_at(terms, t);
  const boost::math::normal standard;
  const double v = t * std::sqrt(at.second);
  if (std::abs(v) < kAtTheMean) {
    return boost::math::cdf(standard, at.third / (6.0 * std::pow(at.second, 1.5)));
  }
  const double w = std::copysign(std::sqrt(std::max(2.0 * (t * x - at.value), 0.0)), t);
  return boost::math::cdf(standard, w + std::log(v / w) / w);
}

}  // namespace montecarta::analysis
