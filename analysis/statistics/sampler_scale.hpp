// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

namespace montecarta::analysis {

/// How many independent draws of equal weight a weighted cloud is worth.
struct EffectiveDraws {
  double of_mean = 0.0;      ///< for its mean: the effective sample size, 1 / sum w^2
  double of_variance = 0.0;  ///< for its covariance: degrees of freedom + 1 (Satterthwaite 1946)
};

/// Of `particles` whose weights do not depend on where they were drawn and have the effective
/// sample size `ess`, in [1, particles]; the sum of their cubes is taken as log-normal weights have
/// it (STATISTICS 4). Of equal weights both are `particles`.
EffectiveDraws effective_draws(std::size_t particles, double ess);

/// Puts the NEES by the spread of particles on the scale of the chi-square. If the particles are
/// independent draws from the distribution that the truth was drawn from, that NEES is a multiple
/// of an F variable (Hotelling; STATISTICS 4), far larger than a chi-square where draws are few.
/// What is as probable under the F as some value under the chi-square becomes that value: of such
/// an ideal sampler the result is chi-square. What an ideal sampler exceeds once in a million
/// samples grows in proportion from there on, so that a NEES a thousand times too large is that on
/// this scale as well.
class SamplerScale {
 public:
  explicit SamplerScale(std::size_t dimension);

  /// Whether the NEES of an ideal sampler has a mean: more than dimension + 2 effective draws.
  bool can_judge(const EffectiveDraws& draws) const;
  /// `nees` >= 0 of draws that can_judge() takes, to a thousandth (a table); NaN stays
  /// NaN.
  double operator()(double nees, const EffectiveDraws& draws) const;

 private:
  double entry(std::size_t row, std::size_t column) const;

  double dimension_;
  std::size_t columns_;             ///< values of the chi-square, at equal steps of their logarithm
  std::vector<double> log_ratios_;  ///< {1 / freedom, chi-square} log2 of d F / chi-square
};

/// The table of 1 to 3 components, made once and read by all threads.
const SamplerScale& sampler_scale(std::size_t dimension);

}  // namespace montecarta::analysis
