// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/sampler_scale.hpp"

#include "engine/errors.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace montecarta::analysis {
namespace {

constexpr double kFirstOctave = -16.0, kStepsPerOctave = 8.0;  // of the chi-square
constexpr std::size_t kFreedoms = 128;  // steps of 1 / freedom from 0 to kMostInverse
constexpr double kMostInverse = 0.5;
constexpr double kLastTail = 1e-6;  // beyond, an ideal sampler hardly ever is

/// d F / chi-square of the same probability, F with d and 1 / `inverse` degrees of freedom.
double f_ratio(double chi_square, double d, double inverse) {
  if (inverse == 0.0) return 1.0;
  const boost::math::fisher_f ideal(d, 1.0 / inverse);
  const boost::math::chi_squared normal(d);
  const double above = boost::math::cdf(boost::math::complement(normal, chi_square));
  const double f = above < 0.5 ? boost::math::quantile(boost::math::complement(ideal, above))
                               : boost::math::quantile(ideal, boost::math::cdf(normal, chi_square));
  return d * f / chi_square;
}

}  // namespace

EffectiveDraws effective_draws(std::size_t particles, double ess) {
  const auto M = static_cast<double>(particles);
  const double E = std::clamp(ess, 1.0, M);
  if (E <= 1.0 || E >= M) return {E, E};
  const double cubes = std::min(M / (E * E * E), 1.0 / (E * std::sqrt(E)));
  const double freedom = std::pow(1.0 - 1.0 / E, 2) / (1.0 / E - 2.0 * cubes + 1.0 / (E * E));
  return {E, std::min(freedom + 1.0, M)};
}

SamplerScale::SamplerScale(std::size_t dimension) : dimension_(static_cast<double>(dimension)) {
  const double last = boost::math::quantile(
      boost::math::complement(boost::math::chi_squared(dimension_), kLastTail));
  columns_ = static_cast<std::size_t>((std::log2(last) - kFirstOctave) * kStepsPerOctave) + 1;
  for (std::size_t row = 0; row <= kFreedoms; ++row) {
    const double inverse = kMostInverse * static_cast<double>(row) / kFreedoms;
    for (std::size_t column = 0; column < columns_; ++column) {
      const double octave = kFirstOctave + static_cast<double>(column) / kStepsPerOctave;
      log_ratios_.push_back(std::log2(f_ratio(std::exp2(octave), dimension_, inverse)));
    }
  }
}

bool SamplerScale::can_judge(const EffectiveDraws& draws) const {
  return draws.of_mean > dimension_ + 2.0;
}

double SamplerScale::entry(std::size_t row, std::size_t column) const {
  return log_ratios_[row * columns_ + column];
}

double SamplerScale::operator()(double nees, const EffectiveDraws& draws) const {
  expect(can_judge(draws), "enough draws to be judged by their spread");
  if (std::isnan(nees) || nees == 0.0) return nees;
  const double E = draws.of_mean, freedom = draws.of_variance - dimension_;  // second of the F
  const double f = nees * (E - 1.0) / (E + 1.0) * freedom / (draws.of_variance - 1.0);  // times d
  const double place = std::min(1.0 / (freedom * kMostInverse), 1.0) * kFreedoms;
  const auto row = std::min(static_cast<std::size_t>(place), kFreedoms - 1);
  const double part = place - static_cast<double>(row);
  const auto ratio = [&](std::size_t column) {
    return std::lerp(entry(row, column), entry(row + 1, column), part);
  };
  const auto octave = [](std::size_t column) {
    return kFirstOctave + static_cast<double>(column) / kStepsPerOctave;
  };
  const double log_f = std::log2(f);
  std::size_t below = 0, above = columns_ - 1;  // columns between which f lies
  if (log_f <= octave(below) + ratio(below)) return f * std::exp2(-ratio(below));
  if (log_f >= octave(above) + ratio(above)) return f * std::exp2(-ratio(above));
  while (above - below > 1) {
    const std::size_t middle = (below + above) / 2;
    (octave(middle) + ratio(middle) <= log_f ? below : above) = middle;
  }
  const double first = octave(below) + ratio(below), second = octave(above) + ratio(above);
  return std::exp2(octave(below) + (log_f - first) / ((second - first) * kStepsPerOctave));
}

const SamplerScale& sampler_scale(std::size_t dimension) {
  static const std::array<SamplerScale, 3> scales = {SamplerScale(1), SamplerScale(2),
                                                     SamplerScale(3)};
  return scales[dimension - 1];
}

}  // namespace montecarta::analysis
