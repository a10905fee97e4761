// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/sampler_scale.hpp"

#include "analysis/statistics/distributions.hpp"
#include "engine/errors.hpp"

#include <boost/math/distributions/fisher_f.hpp>

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {
namespace {

// The columns begin at this log2 of the chi-square, and have this many steps per octave.
constexpr double kLeastOctave = -16.0, kStepsPerOctave = 8.0;
constexpr double kMostInverse = 0.5;  // largest 1 / freedom; the steps begin at 0
constexpr double kLastTail = 1e-6;    // tail in which an ideal sampler hardly ever lies

/// d F divided by the chi-square of the same probability, where F has d and 1 / `inverse` degrees
/// of freedom.
double f_ratio(double chi_square, double d, double inverse) {
  if (inverse == 0.0) return 1.0;
  const boost::math::fisher_f ideal(d, 1.0 / inverse);
  const double above = chi_squared_tail(chi_square, d);
  const double f = above < 0.5 ? boost::math::quantile(boost::math::complement(ideal, above))
                               : boost::math::quantile(ideal, chi_squared_cdf(chi_square, d));
  return d * f / chi_square;
}

}  // namespace

EffectiveDraws effective_draws(std::size_t particles, double ess) {
  const auto M = static_cast<double>(particles);
  const double E = std::clamp(ess, 1.0, M);
  if (E <= 1.0 || E >= M) return {E, E};
  const double cubes = std::min(M / (E * E * E), 1.0 / (E * std::sqrt(E)));
  const double rest = 1.0 - 1.0 / E;
  const double freedom = rest * rest / (1.0 / E - 2.0 * cubes + 1.0 / (E * E));
  return {E, std::min(freedom + 1.0, M)};
}

SamplerScale::SamplerScale(std::size_t dimension) : dimension_(static_cast<double>(dimension)) {
  last_octave_ = std::log2(chi_squared_beyond(kLastTail, dimension_));
  columns_ = static_cast<std::size_t>((last_octave_ - kLeastOctave) * kStepsPerOctave) + 1;
  log_f_.resize((kFreedoms + 1) * columns_);
}

double SamplerScale::octave_of(std::size_t column) const {
  return last_octave_ - static_cast<double>(columns_ - 1 - column) / kStepsPerOctave;
}

const double* SamplerScale::row(std::size_t step) const {
  double* const first = log_f_.data() + step * columns_;
  if (is_made_[step].load(std::memory_order_acquire)) return first;
  const std::lock_guard lock(making_);
  if (is_made_[step].load(std::memory_order_relaxed)) return first;
  const double inverse = kMostInverse * static_cast<double>(step) / kFreedoms;
  for (std::size_t column = 0; column < columns_; ++column) {
    const double octave = octave_of(column);
    first[column] = octave + std::log2(f_ratio(std::exp2(octave), dimension_, inverse));
  }
  is_made_[step].store(true, std::memory_order_release);
  return first;
}

bool SamplerScale::can_judge(const EffectiveDraws& draws) const {
  return draws.of_mean > dimension_ + 2.0;
}

SamplerScale::Line SamplerScale::line(const EffectiveDraws& draws) const {
  expect(can_judge(draws), "enough draws to be judged by their spread");
  // `freedom` is the second number of degrees of freedom of F.
  const double E = draws.of_mean, freedom = draws.of_variance - dimension_;
  const double place = std::min(1.0 / (freedom * kMostInverse), 1.0) * kFreedoms;
  const auto step = std::min(static_cast<std::size_t>(place), kFreedoms - 1);
  Line line;
  line.lower_ = row(step);
  line.upper_ = row(step + 1);
  line.part_ = place - static_cast<double>(step);
  line.last_ = columns_ - 1;
  line.factor_ = (E - 1.0) / (E + 1.0) * freedom / (draws.of_variance - 1.0);
  line.first_octave_ = octave_of(0);
  line.beyond_ = std::exp2(last_octave_ - line.log_f_at(line.last_));
  return line;
}

double SamplerScale::shown_ratio(double ratio, const EffectiveDraws& draws) const {
  const Line line = this->line(draws);
  double sum = 0.0, above = 1.0;  // `above` is the probability above the column
  for (std::size_t column = 0; column + 1 < columns_; ++column) {
    const double next = chi_squared_tail(std::exp2(octave_of(column + 1)), dimension_);
    const double log_f = 0.5 * (line.log_f_at(column) + line.log_f_at(column + 1));
    sum += (above - next) * line(ratio * std::exp2(log_f) / line.factor_);
    above = next;
  }
  return sum / dimension_;
}

double SamplerScale::Line::operator()(double nees) const {
  if (std::isnan(nees) || nees == 0.0) return nees;
  const double f = nees * factor_;
  const double log_f = std::log2(f);
  if (log_f >= log_f_at(last_)) return f * beyond_;
  if (log_f <= log_f_at(0)) return f * std::exp2(first_octave_ - log_f_at(0));
  // The search begins where f would lie if the ratio were 1.
  const double near = std::max((log_f - first_octave_) * kStepsPerOctave, 0.0);
  std::size_t below = std::min(static_cast<std::size_t>(near), last_ - 1);
  while (log_f_at(below) > log_f) --below;
  while (log_f_at(below + 1) <= log_f) ++below;
  const double first = log_f_at(below), second = log_f_at(below + 1);
  const double place = static_cast<double>(below) + (log_f - first) / (second - first);
  return std::exp2(first_octave_ + place / kStepsPerOctave);
}

const SamplerScale& sampler_scale(std::size_t dimension) {
  static const std::array<SamplerScale, 3> scales = {SamplerScale(1), SamplerScale(2),
                                                     SamplerScale(3)};
  return scales[dimension - 1];
}

}  // namespace montecarta::analysis
