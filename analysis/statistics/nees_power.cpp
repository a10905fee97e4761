// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/nees_power.hpp"

#include "engine/errors.hpp"

#include <boost/math/distributions/gamma.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace montecarta::analysis {
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
