// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/consistency.hpp"

#include "analysis/statistics/means.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/gamma.hpp>
#include <boost/math/distributions/normal.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

namespace montecarta::analysis {
namespace {

constexpr double kLeastVariance = 1e-9;  // of run averages that are equal: times the dimension

/// Mean of the values that are numbers, in index order; NaN where there is none.
double mean_of_numbers(const std::vector<double>& values) {
  double sum = 0.0;
  std::size_t n = 0;
  for (const double value : values) {
    if (std::isnan(value)) continue;
    sum += value;
    ++n;
  }
  return n == 0 ? kNaN : sum / static_cast<double>(n);
}

std::vector<double> numbers_in(const std::vector<double>& values) {
  std::vector<double> numbers;
  for (const double value : values) {
    if (!std::isnan(value)) numbers.push_back(value);
  }
  return numbers;
}

/// Scans against the two bands.
void compare_scans(const NeesSeries& series, std::span<const double> times, Consistency& result) {
  std::vector<bool> above(series.average.size());
  std::size_t tested = 0, n_above = 0, n_below = 0;
  for (std::size_t s = 0; s < series.average.size(); ++s) {
    const double average = series.average[s];
    if (std::isnan(average)) continue;
    ++tested;
    above[s] = average > series.bounds[s].upper;
    n_above += above[s] ? 1 : 0;
    n_below += average < series.bounds[s].lower ? 1 : 0;
    const Interval& whole_run = series.whole_run_bounds[s];
    if (!result.above_from && average > whole_run.upper) result.above_from = times[s];
    if (!result.below_from && average < whole_run.lower) result.below_from = times[s];
  }
  const auto share = [&](std::size_t n) {
    return tested == 0 ? kNaN : static_cast<double>(n) / static_cast<double>(tested);
  };
  result.share_above = share(n_above);
  result.share_below = share(n_below);
  result.share_inside = share(tested - n_above - n_below);
  if (const auto exit = first_lasting(above, kLastingScans)) result.lasting_exit = times[*exit];
}

Verdict verdict(const Consistency& found) {
  if (std::isnan(found.share_inside)) return Verdict::untested;
  const bool above = found.above_from || found.mean > found.average_bounds.upper;
  const bool below = found.below_from || found.mean < found.average_bounds.lower;
  if (above) return found.lasting_exit ? Verdict::inconsistent : Verdict::optimistic;
  return below ? Verdict::conservative : Verdict::consistent;
}

}  // namespace

std::optional<std::size_t> first_lasting(const std::vector<bool>& above, std::size_t length) {
  std::size_t in_a_row = 0;
  for (std::size_t s = 0; s < above.size(); ++s) {
    in_a_row = above[s] ? in_a_row + 1 : 0;
    if (in_a_row == length) return s + 1 - length;
  }
  return std::nullopt;
}

Interval run_average_bounds(std::span<const double> run_averages, std::size_t dimension,
                            double deviate) {
  const auto n = static_cast<double>(run_averages.size());
  double mean = 0.0, squares = 0.0;
  for (const double average : run_averages) mean += average / n;
  for (const double average : run_averages) squares += (average - mean) * (average - mean);
  if (n < 3.0) return {0.0, std::numeric_limits<double>::infinity()};
  const auto d = static_cast<double>(dimension);
  // Of a consistent filter the average varies no more than a single scan does; runs that went
  // astray do, also where they went too far for numbers. Of gamma samples the deviation divided by
  // the mean, not the deviation itself, is independent of the mean (Lukacs).
  const double most = 2.0 * d, estimate = squares / (n - 1.0) * (d / mean) * (d / mean);
  const double variance = (estimate <= most ? std::max(estimate, kLeastVariance * d) : most) / n;
  const double tail = boost::math::cdf(boost::math::normal(), -deviate);
  const boost::math::gamma_distribution<> average(d * d / variance, variance / d);
  return {boost::math::quantile(average, tail),
          boost::math::quantile(boost::math::complement(average, tail))};
}

double expected_median(std::size_t dimension) {
  return boost::math::median(boost::math::chi_squared(static_cast<double>(dimension)));
}

// The mean of a chi-square between two quantiles, by x f_d(x) = d f_{d+2}(x).
double expected_trimmed(std::size_t dimension) {
  const auto d = static_cast<double>(dimension);
  const boost::math::chi_squared nees(d), weighted(d + 2.0);
  const double low = boost::math::quantile(nees, kTrimmedShare);
  const double high = boost::math::quantile(nees, 1.0 - kTrimmedShare);
  const double part = boost::math::cdf(weighted, high) - boost::math::cdf(weighted, low);
  return d * part / (1.0 - 2.0 * kTrimmedShare);
}

Consistency judge(const NeesSeries& series, std::span<const double> times) {
  Consistency result;
  result.mean = mean_of_numbers(series.average);
  result.median = mean_of_numbers(series.median);
  result.trimmed = mean_of_numbers(series.trimmed);
  const std::vector<double> averages = numbers_in(series.run_averages);
  result.average_bounds = run_average_bounds(averages, series.dimension, series.average_deviate);
  compare_scans(series, times, result);
  result.verdict = verdict(result);
  return result;
}

std::string in_words(const Consistency& consistency) {
  switch (consistency.verdict) {
    case Verdict::untested:
      return "not tested";
    case Verdict::consistent:
      return "consistent";
    case Verdict::optimistic:
      return "optimistic";
    case Verdict::conservative:
      return "conservative";
    case Verdict::inconsistent:
      break;
  }
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "inconsistent from %.1f s", *consistency.lasting_exit);
  return text.data();
}

}  // namespace montecarta::analysis
