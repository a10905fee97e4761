// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/run_average.hpp"

#include <boost/math/distributions/gamma.hpp>
#include <boost/math/distributions/normal.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace montecarta::analysis {
namespace {

constexpr double kLeastVariation = 1e-9;      // of run averages that are equal
constexpr double kOverdispersedErrors = 3.0;  // standard errors
constexpr double kLeastTail = 1e-300;
constexpr double kLeastExactVariance = 1e-7;

/// Squared deviation of the values in units of their mean; NaN where it is not a number.
double variation_of(std::span<const double> values) {
  const auto n = static_cast<double>(values.size());
  double mean = 0.0, squares = 0.0;
  for (const double value : values) mean += value / n;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return squares / (n - 1.0) / mean / mean;
}

/// Quantile of a gamma of mean 1 and this variance, where a normal distribution has `deviate`. With
/// few runs the deviate is so large that no double holds the tail: the end of the distribution
/// then. Of a small variance, where Boost's series need too many terms, by Wilson and Hilferty, to
/// 1e-8.
double gamma_quantile(double variance, double deviate) {
  if (variance < kLeastExactVariance) {
    const double third = variance / 9.0;
    return std::pow(1.0 - third + deviate * std::sqrt(third), 3);
  }
  const double tail = boost::math::cdf(boost::math::normal(), -std::abs(deviate));
  if (tail < kLeastTail) return deviate < 0.0 ? 0.0 : std::numeric_limits<double>::infinity();
  const boost::math::gamma_distribution<> gamma(1.0 / variance, variance);
  return deviate < 0.0 ? boost::math::quantile(gamma, tail)
                       : boost::math::quantile(boost::math::complement(gamma, tail));
}

/// The normal deviate z of a studentised mean whose z + c (2 z^2 + 1) is `deviate`: the first term
/// of its Edgeworth expansion in the skewness (Hall). Where there is none, the vertex.
double without_skew(double deviate, double c) {
  if (c == 0.0) return deviate;
  const double root = 1.0 - 8.0 * c * (c - deviate);
  return (std::sqrt(std::max(root, 0.0)) - 1.0) / (4.0 * c);
}

}  // namespace

Interval AverageLaw::bounds() const {
  if (runs < 3.0) return {0.0, std::numeric_limits<double>::infinity()};
  // A gamma of this variance has a skewness of 2 sqrt(variation), which its quantiles know of.
  const double c = (skew - 1.0) * std::sqrt(variation / runs) / 3.0;
  return {gamma_quantile(variation / runs, without_skew(-deviate, c)),
          gamma_quantile(variation / runs, without_skew(deviate, c))};
}

AverageLaw average_law(std::span<const double> run_averages, std::size_t dimension, double deviate,
                       double skew) {
  const double most = 2.0 / static_cast<double>(dimension);
  const double estimate = variation_of(run_averages);
  return {.variation = estimate <= most ? std::max(estimate, kLeastVariation) : most,
          .runs = static_cast<double>(run_averages.size()),
          .deviate = deviate,
          .skew = skew};
}

bool is_overdispersed(std::span<const double> run_averages, std::size_t dimension) {
  const auto n = static_cast<double>(run_averages.size());
  if (n < 3.0) return false;
  const double most = 2.0 / static_cast<double>(dimension);
  const double excess = std::log(variation_of(run_averages) / most);
  return !(excess <= kOverdispersedErrors * std::sqrt((2.0 + 2.0 * most) / n));  // also NaN
}

Interval least_ratios(const AverageLaw& law, double power) {
  const Interval bounds = law.bounds();
  if (law.runs < 3.0) return {0.0, std::numeric_limits<double>::infinity()};
  const double deviate = boost::math::quantile(boost::math::normal(), power);
  const double variance = law.variation / law.runs;
  return {bounds.lower / gamma_quantile(variance, deviate),
          bounds.upper / gamma_quantile(variance, -deviate)};
}

std::uint64_t runs_that_decide(AverageLaw law, double within) {
  const auto decide = [&](std::uint64_t runs) {
    law.runs = static_cast<double>(runs);
    const Interval bounds = law.bounds();
    return bounds.upper <= within * bounds.lower;
  };
  std::uint64_t enough = 3;
  while (!decide(enough) && enough < kMostDecidingRuns) enough *= 2;
  std::uint64_t too_few = enough / 2;
  while (enough - too_few > 1) {
    const std::uint64_t middle = too_few + (enough - too_few) / 2;
    (decide(middle) ? enough : too_few) = middle;
  }
  return std::min(enough, kMostDecidingRuns);
}

}  // namespace montecarta::analysis
