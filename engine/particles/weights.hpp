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

  void make_equal() {
    heaviest_ = 0;
    const double share = 1.0 / static_cast<double>(particles_);
    std::fill(log_.begin(), log_.end(), Real(std::log(share)));
    std::fill(linear_.begin(), linear_.end(), Real(share));
    clear_padding();
    effective_ = 1.0 / sum_of_squares();
  }

  /// Multiplies a block of weights by exp(increment); normalise() must follow.
  void multiply(std::size_t block, const Real& log_increment) { log_[block] += log_increment; }

  /// Makes the weights sum to one and returns the log of their previous sum, which is the
  /// log-likelihood of the scan. Throws std::runtime_error if all weights are zero or one is NaN.
  double normalise() {
    double peak = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < particles_; ++i) {
      const double weight = log_scalars()[i];
      if (std::isnan(weight)) throw std::runtime_error("a particle's weight is not a number");
      if (weight > peak) peak = weight, heaviest_ = i;
    }
    if (!std::isfinite(peak))
      throw std::runtime_error("no particle explains the scan (all weights are zero)");
    for (std::size_t b = 0; b < log_.size(); ++b) linear_[b] = exp(log_[b] - Real(peak));
    double sum = 0.0;
    for (double weight : linear_scalars()) sum += weight;
    const double log_sum = peak + std::log(sum);
    for (std::size_t b = 0; b < log_.size(); ++b) {
      linear_[b] = linear_[b] * Real(1.0 / sum);
      log_[b] -= Real(log_sum);
    }
    clear_padding();
    effective_ = 1.0 / sum_of_squares();
    return log_sum;
  }

  /// Effective number of particles, 1 / sum of squares (Kong, Liu and Wong 1994).
  double effective() const { return effective_; }

 private:
  double sum_of_squares() const {
    double squares = 0.0;
    for (double weight : linear_scalars()) squares += weight * weight;
    return squares;
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
