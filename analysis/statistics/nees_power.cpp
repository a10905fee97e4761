// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/nees_power.hpp"

#include "engine/errors.hpp"

#include <boost/math/distributions/gamma.hpp>
#include <boost/math/distributions/normal.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

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

namespace {

std::size_t checked_scans(const NeesTest& test) {
  if (test.scans > 0 && test.scans <= kMostPlannedScans) return test.scans;
  throw StudyError("scans = " + std::to_string(test.scans) +
                   " (a run has 1 to 100000 independent scans): give what a run has");
}

void expect_ratio(double ratio) {
  if (ratio > 0.0 && std::isfinite(ratio) && ratio != 1.0) return;
  throw StudyError("ratio = " + std::to_string(ratio) +
                   " (how many times too large or too small the NEES is, so neither 1 nor 0): "
                   "give for instance 1.5 or 0.67");
}

void expect_power(double power) {
  if (power > 0.0 && power < 1.0) return;
  throw StudyError("power = " + std::to_string(power) +
                   " (a probability strictly between 0 and 1): give for instance 0.9");
}

void expect_margin(double within) {
  if (within > 1.0 && std::isfinite(within)) return;
  throw StudyError("within = " + std::to_string(within) +
                   " (a ratio above 1 is needed): give for instance 1.1");
}

/// Probability that an average of this law is below `value` times its expectation.
double below(const AverageLaw& law, double value) {
  const double variance = law.variation / law.runs;
  if (value <= 0.0) return 0.0;
  if (std::isinf(value)) return 1.0;
  return boost::math::cdf(boost::math::gamma_distribution<>(1.0 / variance, variance), value);
}

}  // namespace

NeesPlan::NeesPlan(const NeesTest& test) : test_(test), walks_(checked_scans(test)) {
  nees_bounds(1, test.dimension, test.level);  // refuses what is no dimension or level
}

AverageLaw NeesPlan::law(std::uint64_t runs) const {
  const std::vector<double> independent(test_.scans - 1, 0.0);
  const WholeRunTest test = walks_.test(independent, runs, test_.dimension, test_.level);
  return {.variation = 2.0 / static_cast<double>(test_.dimension * test_.scans),
          .runs = static_cast<double>(runs),
          .deviate = test.average_deviate};
}

double NeesPlan::found(double ratio, std::uint64_t runs) const {
  expect_ratio(ratio);
  const AverageLaw average = law(runs);
  const Interval bounds = average.bounds();
  return ratio > 1.0 ? 1.0 - below(average, bounds.upper / ratio)
                     : below(average, bounds.lower / ratio);
}

double NeesPlan::shown(double within, std::uint64_t runs) const {
  expect_margin(within);
  const AverageLaw average = law(runs);
  const Interval bounds = average.bounds();
  return std::max(0.0,
                  below(average, bounds.lower * within) - below(average, bounds.upper / within));
}

std::uint64_t NeesPlan::runs_to_find(double ratio, double power) const {
  expect_ratio(ratio);
  expect_power(power);
  return fewest([&](std::uint64_t runs) { return found(ratio, runs) >= power; });
}

std::uint64_t NeesPlan::runs_to_show(double within, double power) const {
  expect_margin(within);
  expect_power(power);
  return fewest([&](std::uint64_t runs) { return shown(within, runs) >= power; });
}

std::uint64_t NeesPlan::runs_to_decide(double within) const {
  expect_margin(within);
  return fewest([&](std::uint64_t runs) {
    const Interval bounds = law(runs).bounds();
    return bounds.upper <= within * bounds.lower;
  });
}

std::uint64_t NeesPlan::fewest(const std::function<bool(std::uint64_t)>& is_enough) const {
  std::uint64_t enough = 3;  // fewer say nothing
  while (!is_enough(enough)) {
    if (enough >= kMostPlannedRuns) {
      throw StudyError("more than " + std::to_string(kMostPlannedRuns) +
                       " runs would be needed: take a ratio farther from 1");
    }
    enough *= 2;
  }
  std::uint64_t too_few = enough == 3 ? 2 : enough / 2;
  while (enough - too_few > 1) {
    const std::uint64_t middle = too_few + (enough - too_few) / 2;
    (is_enough(middle) ? enough : too_few) = middle;
  }
  return enough;
}

}  // namespace montecarta::analysis
