// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/uniformity.hpp"

#include "engine/errors.hpp"

#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/poisson.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace montecarta::analysis {
namespace {

/// Probability that at most `count` of `values` are at or below the point.
double probability_up_to(std::size_t count, std::size_t values, std::size_t point) {
  const boost::math::binomial law(static_cast<double>(values), ecdf_point(point));
  return boost::math::cdf(law, static_cast<double>(count));
}

/// Poisson probabilities of first, first + 1, ...; those below 1e-20 are left out.
struct Increments {
  std::size_t first = 0;
  std::vector<double> probability;
};

Increments poisson_increments(std::size_t values) {
  const double mean = static_cast<double>(values) / static_cast<double>(kEcdfSteps);
  const boost::math::poisson law(mean);
  Increments found;
  for (std::size_t k = 0; k <= values; ++k) {
    const double probability = boost::math::pdf(law, static_cast<double>(k));
    const bool is_negligible = probability < 1e-20;
    if (is_negligible && static_cast<double>(k) > mean) break;
    if (is_negligible) found.first = k + 1;
    if (!is_negligible) found.probability.push_back(probability);
  }
  return found;
}

/// Counts of uniform values are distributed as those of a Poisson process given its total. The
/// recursion follows the count from point to point, through paths that stay within the band.
double joint_probability(const EcdfBand& band) {
  const std::size_t n = band.values;
  const Increments step = poisson_increments(n);
  std::vector<double> now(n + 1, 0.0);
  now[0] = 1.0;
  for (std::size_t point = 1; point <= kEcdfSteps; ++point) {
    std::vector<double> next(n + 1, 0.0);
    for (std::size_t k = band.lower[point - 1]; k <= band.upper(point - 1); ++k) {
      if (now[k] == 0.0) continue;
      const std::size_t begin = std::max(k + step.first, band.lower[point]);
      const std::size_t end =
          std::min(k + step.first + step.probability.size(), band.upper(point) + 1);
      for (std::size_t m = begin; m < end; ++m) {
        next[m] += now[k] * step.probability[m - k - step.first];
      }
    }
    now = std::move(next);
  }
  const auto total = static_cast<double>(n);
  return now[n] / boost::math::pdf(boost::math::poisson(total), total);
}

/// The band that the count at each point leaves on either side with a probability of at most
/// `tail`.
EcdfBand band_with_tails(std::size_t values, double tail) {
  EcdfBand band{.values = values, .lower = {}};
  for (std::size_t point = 1; point < kEcdfSteps; ++point) {
    std::size_t count = band.lower[point - 1], end = values;  // ends of the bisection
    while (count < end) {
      const std::size_t middle = count + (end - count) / 2;
      const bool is_below = probability_up_to(middle, values, point) <= tail;
      (is_below ? count : end) = is_below ? middle + 1 : middle;
    }
    band.lower[point] = count;
  }
  band.lower[kEcdfSteps] = values;
  band.joint = joint_probability(band);
  return band;
}

/// The least pointwise tail of the counts, which leave every band with larger tails.
double least_tail(const EcdfCounts& counts, std::size_t values) {
  double least = 1.0;
  for (std::size_t point = 1; point < kEcdfSteps; ++point) {
    least = std::min({least, probability_up_to(counts[point], values, point),
                      probability_up_to(values - counts[point], values, kEcdfSteps - point)});
  }
  return least;
}

bool stays_within(const EcdfCounts& counts, const EcdfBand& band) {
  for (std::size_t j = 0; j < counts.size(); ++j) {
    if (counts[j] < band.lower[j] || counts[j] > band.upper(j)) return false;
  }
  return true;
}

void evaluate(std::span<const double> values, Uniformity& found) {
  const auto n = static_cast<double>(values.size());
  std::vector<double> sorted(values.begin(), values.end());
  std::ranges::sort(sorted);
  found.deviation = found.mean = found.variance = 0.0;
  for (std::size_t j = 0; j < found.counts.size(); ++j) {
    found.counts[j] =
        static_cast<std::size_t>(std::ranges::upper_bound(sorted, ecdf_point(j)) - sorted.begin());
    const double deviation = static_cast<double>(found.counts[j]) / n - ecdf_point(j);
    if (std::abs(deviation) > std::abs(found.deviation)) found.deviation = deviation;
  }
  for (const double value : values) found.mean += value / n;
  for (const double value : values) {
    found.variance += (value - found.mean) * (value - found.mean) / n;
  }
}

Calibration name_fault(const Uniformity& found, PitOf kind) {
  const auto n = static_cast<double>(found.band.values);
  const double shift = (found.mean - 0.5) * std::sqrt(12.0 * n);
  const double spread = (found.variance - 1.0 / 12.0) * std::sqrt(180.0 * n);
  const bool is_shifted = std::abs(shift) > std::abs(spread);
  if (kind == PitOf::error) {
    if (is_shifted) return Calibration::shifted;
    return spread > 0.0 ? Calibration::too_narrow : Calibration::too_wide;
  }
  if (!is_shifted) return Calibration::wrong_shape;
  return shift > 0.0 ? Calibration::too_narrow : Calibration::too_wide;
}

}  // namespace

EcdfBand ecdf_band(std::size_t values, double level) {
  if (values == 0) return {};
  // The bisection begins between the tail that Bonferroni's inequality gives over all points and
  // both sides, and the tail of one point alone.
  double inside = 0.5 * (1.0 - level) / static_cast<double>(kEcdfSteps - 1);
  double outside = 0.5 * (1.0 - level);
  EcdfBand best = band_with_tails(values, inside);
  for (int halving = 0; halving < 14; ++halving) {
    const double tail = std::sqrt(inside * outside);
    EcdfBand band = band_with_tails(values, tail);
    const bool is_wide = band.joint >= level;
    (is_wide ? inside : outside) = tail;
    if (is_wide) best = band;
  }
  return best;
}

Uniformity judge_uniformity(std::span<const double> values, const EcdfBand& band, PitOf kind) {
  expect(values.size() == band.values, "a band is that of the number of values");
  Uniformity found;
  found.band = band;
  if (values.size() < kLeastValues) return found;
  evaluate(values, found);
  const bool fits = stays_within(found.counts, band);
  found.verdict = fits ? Calibration::calibrated : name_fault(found, kind);
  return found;
}

double p_value(const Uniformity& test) {
  const std::size_t n = test.band.values;
  if (n < kLeastValues) return Uniformity::kNone;
  // The p-value of a smaller tail would be lost in the rounding of the joint probability.
  constexpr double kLeastPointwiseTail = 1e-14;
  const double tail = std::max(least_tail(test.counts, n), kLeastPointwiseTail);
  return std::clamp(1.0 - band_with_tails(n, tail).joint, 0.0, 1.0);
}

std::string in_words(Calibration verdict) {
  constexpr std::array kWords = {"too few values", "no fault found", "too narrow",
                                 "too wide",       "shifted",        "wrong shape"};
  return kWords.at(static_cast<std::size_t>(verdict));
}

}  // namespace montecarta::analysis
