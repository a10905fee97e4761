// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/particles/blocks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

namespace montecarta::engine {

/// Weights of a particle population, kept as logarithms. Dead lanes have weight zero.
template <class Real>
class Weights {
 public:
  explicit Weights(std::size_t particles)
      : particles_(particles), log_(blocks_for<Real>(particles)), linear_(log_.size()) {
    make_equal();
  }

  std::size_t particles() const { return particles_; }
  const std::vector<Real>& linear() const { return linear_; }
  std::span<const double> linear_scalars() const { return scalars(linear_).first(particles_); }
  std::span<const double> log_scalars() const { return scalars(log_).first(particles_); }
  const Real& log(std::size_t block) const { return log_[block]; }

  /// A particle with the greatest weight.
  std::size_t heaviest() const { return heaviest_; }

  void make_equal() { make_equal(StepContext::before_all_steps()); }
  void make_equal(const StepContext& context) {
    heaviest_ = 0;
    const double share = 1.0 / static_cast<double>(particles_);
    const Real log_share(std::log(share));
    const double squares = sum_of_parts<Real>(context, log_.size(), [&](auto first, auto n) {
      std::fill_n(log_.begin() + static_cast<std::ptrdiff_t>(first), n, log_share);
      std::fill_n(linear_.begin() + static_cast<std::ptrdiff_t>(first), n, Real(share));
      return sum_of_squares(first, n);
    });
    effective_ = 1.0 / squares;
    clear_padding();
  }

  /// Multiplies a block of weights by exp(increment); normalise() must follow.
  void multiply(std::size_t block, const Real& log_increment) { log_[block] += log_increment; }

  /// Makes the weights sum to one and returns the log of their previous sum, which is the
  /// log-likelihood of the scan. Throws std::runtime_error if all weights are zero or one is NaN.
  double normalise(const StepContext& context) {
    const Peak peak = joined_parts<Real>(
        context, log_.size(), [&](auto first, auto n) { return peak_of(first, n); },
        [](Peak& whole, const Peak& part) {
          if (part.log_weight > whole.log_weight) whole = part;
        });
    if (!std::isfinite(peak.log_weight))
      throw std::runtime_error("no particle explains the scan (all weights are zero)");
    heaviest_ = peak.particle;
    const double sum = sum_of_parts<Real>(context, log_.size(), [&](auto first, auto n) {
      for (std::size_t b = first; b < first + n; ++b)
        linear_[b] = exp(log_[b] - Real(peak.log_weight));
      return sum_of(first, n, [](double weight) { return weight; });
    });
    const double log_sum = peak.log_weight + std::log(sum);
    const double squares = sum_of_parts<Real>(context, log_.size(), [&](auto first, auto n) {
      for (std::size_t b = first; b < first + n; ++b) {
        linear_[b] = linear_[b] * Real(1.0 / sum);
        log_[b] -= Real(log_sum);
      }
      return sum_of_squares(first, n);
    });
    effective_ = 1.0 / squares;
    clear_padding();
    return log_sum;
  }

  /// Effective sample size, (18.1) of EQUATIONS.
  double effective() const { return effective_; }

 private:
  struct Peak {
    double log_weight = -std::numeric_limits<double>::infinity();
    std::size_t particle = 0;
  };

  /// The particle behind the last one of n blocks, without dead lanes.
  std::size_t end_of(std::size_t first, std::size_t n) const {
    return std::min(particles_, (first + n) * kLanesOf<Real>);
  }
  Peak peak_of(std::size_t first, std::size_t n) const {
    Peak peak;
    for (std::size_t i = first * kLanesOf<Real>; i < end_of(first, n); ++i) {
      const double weight = log_scalars()[i];
      if (std::isnan(weight)) throw std::runtime_error("a particle's weight is not a number");
      if (weight > peak.log_weight) peak = {weight, i};
    }
    return peak;
  }
  template <class Term>
  double sum_of(std::size_t first, std::size_t n, const Term& term) const {
    double sum = 0.0;
    for (std::size_t i = first * kLanesOf<Real>; i < end_of(first, n); ++i)
      sum += term(linear_scalars()[i]);
    return sum;
  }
  double sum_of_squares(std::size_t first, std::size_t n) const {
    return sum_of(first, n, [](double weight) { return weight * weight; });
  }
  void clear_padding() {
    for (std::size_t i = particles_; i < scalars(log_).size(); ++i) {
      scalars(log_)[i] = -std::numeric_limits<double>::infinity();
      scalars(linear_)[i] = 0.0;
    }
  }

  std::size_t particles_;
  std::size_t heaviest_ = 0;
  double effective_ = 0.0;
  std::vector<Real> log_;
  std::vector<Real> linear_;
};

}  // namespace montecarta::engine
