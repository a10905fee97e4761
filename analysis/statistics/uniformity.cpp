// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/uniformity.hpp"

#include <boost/math/distributions/binomial.hpp>

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {
namespace {

/// Logarithm of the Poisson probability of `count` where `mean` is expected.
double log_poisson(std::size_t count, double mean) {
  const auto k = static_cast<double>(count);
  return k * std::log(mean) - mean - std::lgamma(k + 1.0);
}

/// Probability that all bins hold between `lower` and `upper` of `values`, uniform over `bins`.
double probability_within(std::size_t values, std::size_t bins, std::size_t lower,
                          std::size_t upper) {
  const double mean = static_cast<double>(values) / static_cast<double>(bins);
  std::vector<double> one(values + 1, 0.0), sum(values + 1, 0.0);
  for (std::size_t k = lower; k <= std::min(upper, values); ++k) {
    one[k] = std::exp(log_poisson(k, mean));
  }
  sum[0] = 1.0;
  for (std::size_t bin = 0; bin < bins; ++bin) {
    std::vector<double> next(values + 1, 0.0);
    for (std::size_t k = 0; k <= values; ++k) {
      if (sum[k] == 0.0) continue;
      for (std::size_t more = lower; more <= std::min(upper, values - k); ++more) {
        next[k + more] += sum[k] * one[more];
      }
    }
    sum = std::move(next);
  }
  return sum[values] / std::exp(log_poisson(values, static_cast<double>(values)));
}

/// The band that each bin by itself leaves with probability `tail` at most on either side.
CountBand band_with_tails(std::size_t values, std::size_t bins, double tail) {
  const boost::math::binomial bin(static_cast<double>(values), 1.0 / static_cast<double>(bins));
  CountBand band{0, values, 1.0};
  while (band.lower < values && cdf(bin, static_cast<double>(band.lower)) <= tail) ++band.lower;
  while (band.upper > band.lower &&
         cdf(complement(bin, static_cast<double>(band.upper - 1))) <= tail) {
    --band.upper;
  }
  return band;
}

Calibration name_fault(const Uniformity& found, double n) {
  const double shift = (found.mean - 0.5) * std::sqrt(12.0 * n);
  const double spread = (found.variance - 1.0 / 12.0) * std::sqrt(180.0 * n);
  if (std::abs(shift) > std::abs(spread)) return Calibration::shifted;
  return spread > 0.0 ? Calibration::too_narrow : Calibration::too_wide;
}

}  // namespace

CountBand joint_band(std::size_t values, std::size_t bins, double level) {
  double inside = 0.0, outside = 0.5;  // tails that are small enough and that are not
  CountBand best{0, values, 1.0};
  for (int halving = 0; halving < 30; ++halving) {
    const double tail = 0.5 * (inside + outside);
    CountBand band = band_with_tails(values, bins, tail);
    band.joint = probability_within(values, bins, band.lower, band.upper);
    const bool wide = band.joint >= level;
    (wide ? inside : outside) = tail;
    if (wide) best = band;
  }
  return best;
}

std::size_t bins_for(std::size_t values) { return std::clamp<std::size_t>(values / 10, 4, 10); }

CountBand band_for(std::size_t values, double level) {
  if (values < kLeastValues) return {0, values, 1.0};
  return joint_band(values, bins_for(values), level);
}

Uniformity judge_uniformity(std::span<const double> values, const CountBand& band) {
  Uniformity found;
  found.band = band;
  const std::size_t bins = bins_for(values.size());
  found.counts.resize(bins);
  const auto n = static_cast<double>(values.size());
  for (const double value : values) {
    const auto bin = static_cast<std::size_t>(value * static_cast<double>(bins));
    ++found.counts[std::min(bin, bins - 1)];
    found.mean += value / n;
    found.variance += (value - 0.5) * (value - 0.5) / n;
  }
  if (values.size() < kLeastValues) return found;
  const bool fits = std::ranges::all_of(found.counts, [&](std::size_t count) {
    return count >= found.band.lower && count <= found.band.upper;
  });
  found.verdict = fits ? Calibration::calibrated : name_fault(found, n);
  return found;
}

std::string in_words(Calibration verdict) {
  switch (verdict) {
    case Calibration::calibrated:
      return "calibrated";
    case Calibration::too_narrow:
      return "too narrow";
    case Calibration::too_wide:
      return "too wide";
    case Calibration::shifted:
      return "shifted";
    case Calibration::untested:
      break;
  }
  return "too few runs";
}

}  // namespace montecarta::analysis
