// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/sampler_scale.hpp"

#include "engine/errors.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {
namespace {

// NEES outside 2^-16 and 2^48 are as far off as those at the ends.
constexpr double kFirstOctave = -16.0, kLastOctave = 48.0, kStepsPerOctave = 8.0;

double on_chi_square(double nees, double d, double M) {
  const boost::math::fisher_f ideal(d, M - d);
  const boost::math::chi_squared chi_square(d);
  const double f = nees * (M - d) / (d * (M + 1.0));
  const double above = boost::math::cdf(boost::math::complement(ideal, f));
  if (above > 0.5) return boost::math::quantile(chi_square, boost::math::cdf(ideal, f));
  return boost::math::quantile(boost::math::complement(chi_square, std::max(above, 1e-300)));
}

}  // namespace

SamplerScale::SamplerScale(std::size_t dimension, std::size_t particles) : particles_(particles) {
  expect(particles > dimension, "more particles than components");
  const auto d = static_cast<double>(dimension), M = static_cast<double>(particles);
  for (double step = 0.0; step <= (kLastOctave - kFirstOctave) * kStepsPerOctave; step += 1.0) {
    const double nees = std::exp2(kFirstOctave + step / kStepsPerOctave);
    log_ratios_.push_back(std::log2(on_chi_square(nees, d, M) / nees));
  }
}

double SamplerScale::operator()(double nees) const {
  if (std::isnan(nees) || nees == 0.0) return nees;
  const double octave = std::clamp(std::log2(nees), kFirstOctave, kLastOctave);
  const double step = (octave - kFirstOctave) * kStepsPerOctave;
  const auto low = std::min(static_cast<std::size_t>(step), log_ratios_.size() - 2);
  const double part = step - static_cast<double>(low);
  return std::exp2(octave + std::lerp(log_ratios_[low], log_ratios_[low + 1], part));
}

}  // namespace montecarta::analysis
