// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/moments/linearised.hpp"

#include <array>
#include <cstddef>
#include <vector>

namespace montecarta {

/// Moments of the predicted detection over all particles, for the normalised innovation squared of
/// the whole filter: the mixture's innovation is the weighted mean, its covariance the mean of S
/// plus the spread of the innovations (weights before the scan). Tasks sum apart and are added in
/// order.
template <class Real>
class InnovationSums {
 public:
  void start(std::size_t tasks, std::size_t matches) {
    matches_ = matches;
    sums_.assign(tasks * matches, Sums{});
  }

  /// `weight` of the lanes that matched, zero for the others.
  [[gnu::always_inline]] void add(std::size_t task, std::size_t k, const Innovation<Real>& v,
                                  const Real& weight) {
    Sums& sums = sums_[task * matches_ + k];
    const Real range = weight * v.value.range, bearing = weight * v.value.bearing;
    sums.range += range;
    sums.bearing += bearing;
    sums.rr += weight * v.s_rr + range * v.value.range;
    sums.rb += weight * v.s_rb + range * v.value.bearing;
    sums.bb += weight * v.s_bb + bearing * v.value.bearing;
  }

  /// nu' S^-1 nu of detection k; `weight` = that of the particles that matched it, > 0.
  double normalised_squared(std::size_t k, double weight) const {
    std::array<double, 5> total{};
    for (std::size_t at = k; at < sums_.size(); at += matches_) {
      const Sums& s = sums_[at];
      const std::array<const Real*, 5> parts{&s.range, &s.bearing, &s.rr, &s.rb, &s.bb};
      for (std::size_t f = 0; f < 5; ++f) {
        for (std::size_t lane = 0; lane < kLanesOf<Real>; ++lane) total[f] += get(*parts[f], lane);
      }
    }
    for (double& sum : total) sum /= weight;
    const auto [r, b, rr, rb, bb] = total;
    const double s_rr = rr - r * r, s_rb = rb - r * b, s_bb = bb - b * b;
    return (s_bb * r * r - 2.0 * s_rb * r * b + s_rr * b * b) / (s_rr * s_bb - s_rb * s_rb);
  }

 private:
  struct Sums {
    Real range{0.0}, bearing{0.0}, rr{0.0}, rb{0.0}, bb{0.0};
  };
  std::size_t matches_ = 0;
  std::vector<Sums> sums_;  ///< {task, match}
};

}  // namespace montecarta
