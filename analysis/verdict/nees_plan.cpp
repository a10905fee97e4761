// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/nees_plan.hpp"

#include "analysis/statistics/distributions.hpp"
#include "analysis/statistics/nees_bounds.hpp"
#include "analysis/statistics/run_mean.hpp"
#include "analysis/verdict/summed_error.hpp"
#include "analysis/verdict/verdict.hpp"
#include "engine/errors.hpp"

#include <boost/math/special_functions/gamma.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace montecarta::analysis {
namespace {

constexpr auto kFamiliesJudged = static_cast<double>(kFamilies.size());
constexpr auto kStretchesJudged = static_cast<double>(kStretches);

/// A sum of squares over runs: `independent` scans of `block` components in each run.
struct PlannedSum {
  double runs, independent, block;

  double freedom() const { return runs * independent * block; }

  /// Interval of the true ratio that the verdict will compute from runs with a ratio of 1 that vary
  /// as much as on average.
  Interval interval(double level) const {
    Summary run;
    run.n = static_cast<std::size_t>(runs);
    run.mean = 1.0;
    run.sd = std::sqrt(2.0 / (independent * block));
    run.skewness = 2.0 * run.sd;  // skewness of a chi-square variable
    return RunMean::of_ratio(run).interval(level);
  }

  /// Probability that the mean is below `ratio` times its expectation.
  double below(double ratio) const {
    return ratio <= 0.0        ? 0.0
           : std::isinf(ratio) ? 1.0
                               : boost::math::gamma_p(0.5 * freedom(), 0.5 * freedom() * ratio);
  }

  /// Probability that the interval of a filter with a ratio of 1 exceeds the margin.
  double not_shown(double within, double level) const {
    const Interval unit = interval(level);
    const double lowest = 1.0 / (within * unit.lower), highest = within / unit.upper;
    return lowest < highest ? below(lowest) + 1.0 - below(highest) : 1.0;
  }
};

/// Probability that the interval of a zero mean of `n` values with deviation 1 is not within
/// +-`margin`.
double mean_not_shown(double margin, double n, double level) {
  const double room = margin * std::sqrt(n) - t_score(level, n - 1.0);
  return room <= 0.0 ? 1.0 : t_p_value(room, n - 1.0);
}

void require_number(bool is_good, const char* name, double value, const char* advice) {
  if (is_good) return;
  throw StudyError("{} = {} {}", name, std::to_string(value), advice);
}

void require_ratio(double ratio) {
  require_number(
      ratio > 0.0 && std::isfinite(ratio) && ratio != 1.0, "ratio", ratio,
      "(how many times too large or too small the NEES is, so neither 1 nor 0): give for "
      "instance 1.5 or 0.67");
}

void require_power(double power) {
  require_number(power > 0.0 && power < 1.0, "power", power,
                 "(a probability strictly between 0 and 1): give for instance 0.9");
}

void require_margin(double within) {
  require_number(within > 1.0 && std::isfinite(within), "within", within,
                 "(a ratio above 1 is needed): give for instance 1.1");
}

}  // namespace

NeesPlan::NeesPlan(const NeesTest& test) : test_(test) {
  if (test.scans == 0 || test.scans > kMostPlannedScans) {
    throw StudyError("scans = {} (a run has 1 to 100000 independent scans): give what a run has",
                     test.scans);
  }
  nees_bounds(1, test.dimension, test.level);  // throws if dimension or level is wrong
}

double NeesPlan::found(double ratio, std::uint64_t runs) const {
  require_ratio(ratio);
  const PlannedSum size{static_cast<double>(runs), static_cast<double>(test_.scans),
                        static_cast<double>(test_.dimension)};
  const Interval unit = size.interval(1.0 - (1.0 - test_.level) / kFamiliesJudged);
  return ratio > 1.0 ? 1.0 - size.below(1.0 / (unit.lower * ratio))
                     : size.below(1.0 / (unit.upper * ratio));
}

double NeesPlan::shown(double within, std::uint64_t runs) const {
  require_margin(within);
  const auto n = static_cast<double>(runs), scans = static_cast<double>(test_.scans);
  const auto d = static_cast<double>(test_.dimension);
  const double level = test_.level;
  double missed = PlannedSum{n, scans, d}.not_shown(within, level);
  if (d > 1.0) missed += d * PlannedSum{n, scans, 1.0}.not_shown(within, level);
  if (scans > 1.0) {  // errors that never change are the same in all stretches
    const double independent = std::max(1.0, std::floor(scans / kStretchesJudged));
    missed += kStretchesJudged * PlannedSum{n, independent, d}.not_shown(within, level);
  }
  missed += d * mean_not_shown(std::sqrt(within - 1.0), n * scans, level);
  missed += 0.5 * d * (d - 1.0) * mean_not_shown(within - 1.0, n * scans, level);
  return std::max(0.0, 1.0 - missed);
}

std::uint64_t NeesPlan::runs_to_find(double ratio, double power) const {
  require_ratio(ratio);
  require_power(power);
  return fewest([&](std::uint64_t runs) { return found(ratio, runs) >= power; });
}

std::uint64_t NeesPlan::runs_to_show(double within, double power) const {
  require_margin(within);
  require_power(power);
  return fewest([&](std::uint64_t runs) { return shown(within, runs) >= power; });
}

std::uint64_t NeesPlan::fewest(const std::function<bool(std::uint64_t)>& is_enough) const {
  std::uint64_t enough = 3;  // fewer runs reject nothing
  while (!is_enough(enough)) {
    if (enough >= kMostPlannedRuns) {
      throw StudyError("more than {} runs would be needed: take a ratio farther from 1",
                       kMostPlannedRuns);
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
