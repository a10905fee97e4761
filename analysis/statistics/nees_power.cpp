// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/nees_power.hpp"

#include "analysis/statistics/nees_bounds.hpp"
#include "engine/errors.hpp"

#include <boost/math/distributions/chi_squared.hpp>

#include <cmath>
#include <string>

namespace montecarta::analysis {
namespace {

void expect_meaning(const NeesTest& test) {
  if (!(test.ratio > 0.0) || !std::isfinite(test.ratio) || test.ratio == 1.0) {
    throw StudyError("ratio = " + std::to_string(test.ratio) +
                     " (how many times too large or too small the NEES is, so neither 1 nor 0): "
                     "give for instance 1.5 or 0.67");
  }
  if (test.scans == 0) {
    throw StudyError("scans = 0 (a test looks at one scan at least): give 1 or more");
  }
}

/// At one scan. The far side is left out: to call an overconfident filter conservative is no
/// detection.
double power_at_one_scan(const NeesTest& test, std::uint64_t runs) {
  const Interval band =
      nees_bounds(runs, test.dimension, level_of_one_scan(test.level, test.scans));
  const double n = static_cast<double>(runs);
  const boost::math::chi_squared sum(n * static_cast<double>(test.dimension));
  return test.ratio > 1.0
             ? boost::math::cdf(boost::math::complement(sum, n * band.upper / test.ratio))
             : boost::math::cdf(sum, n * band.lower / test.ratio);
}

}  // namespace

double level_of_one_scan(double level, std::uint64_t scans) {
  return std::pow(level, 1.0 / static_cast<double>(scans));
}

double nees_power(const NeesTest& test, std::uint64_t runs) {
  expect_meaning(test);
  const double missed = std::log1p(-power_at_one_scan(test, runs));
  return -std::expm1(static_cast<double>(test.scans) * missed);
}

std::uint64_t runs_needed(const NeesTest& test, double power) {
  if (!(power > 0.0 && power < 1.0)) {
    throw StudyError("power = " + std::to_string(power) +
                     " (a probability strictly between 0 and 1): give for instance 0.9");
  }
  std::uint64_t enough = 1;
  while (nees_power(test, enough) < power) {
    if (enough >= kMostPlannedRuns) {
      throw StudyError("ratio = " + std::to_string(test.ratio) + " (more than " +
                       std::to_string(kMostPlannedRuns) +
                       " runs would be needed): take one farther from 1");
    }
    enough *= 2;
  }
  std::uint64_t too_few = enough / 2;  // 0 runs find nothing
  while (enough - too_few > 1) {
    const std::uint64_t middle = too_few + (enough - too_few) / 2;
    (nees_power(test, middle) < power ? too_few : enough) = middle;
  }
  return enough;
}

}  // namespace montecarta::analysis
