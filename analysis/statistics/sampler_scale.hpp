// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <mutex>
#include <vector>

namespace montecarta::analysis {

/// Number of independent draws of equal weight that a weighted set of particles is worth.
struct EffectiveDraws {
  double of_mean = 0.0;  ///< number for the mean: column `ess`
  /// Number for the covariance: degrees of freedom + 1 (Satterthwaite 1946).
  double of_variance = 0.0;
};

/// Effective draws of `particles` whose column `ess` is in [1, particles], if weights do
/// not depend on positions. The sum of cubed weights is that of log-normal weights
/// (STATISTICS 4). For equal weights both are `particles`.
EffectiveDraws effective_draws(std::size_t particles, double ess);

/// Converts the NEES by the spread of particles to the scale of the chi-square. If the particles
/// are independent draws from the distribution of the truth, that NEES is a multiple of an F
/// variable (Hotelling; STATISTICS 4), far larger than a chi-square for few draws. Each value
/// becomes the value of equal probability under the chi-square, so the result is chi-square for
/// such an ideal sampler. Beyond the value that an ideal sampler exceeds once in a million samples,
/// the scale is linear, so that a NEES a thousand times too large stays a thousand times too large.
class SamplerScale {
 public:
  explicit SamplerScale(std::size_t dimension);

  /// The scale for one number of draws, interpolated between two rows of the table. The
  /// SamplerScale must outlive it.
  class Line {
   public:
    /// Converts `nees` >= 0 to a thousandth, by a table; NaN stays NaN.
    double operator()(double nees) const;

   private:
    friend class SamplerScale;
    double log_f_at(std::size_t column) const {
      return lower_[column] + part_ * (upper_[column] - lower_[column]);
    }

    const double *lower_, *upper_;
    double part_;          ///< weight of `upper_` in the interpolation, in [0, 1]
    std::size_t last_;     ///< index of the last column of the table
    double factor_;        ///< ratio of d F to the NEES
    double first_octave_;  ///< log2 of the chi-square of the first column
    double beyond_;        ///< ratio of the chi-square to d F beyond the last column
  };

  /// Returns whether the NEES of an ideal sampler has a mean, which takes more than dimension + 2
  /// effective draws.
  bool can_judge(const EffectiveDraws& draws) const;
  /// The scale for `draws`, for which can_judge() must be true.
  Line line(const EffectiveDraws& draws) const;
  /// The mean of the converted NEES divided by the dimension, to a thousandth, if squared errors
  /// are `ratio` times those of an ideal sampler: 1 for a ratio of 1, and nearer to 1 than `ratio`
  /// otherwise, since the F law has heavier tails than the chi-square.
  double shown_ratio(double ratio, const EffectiveDraws& draws) const;
  double operator()(double nees, const EffectiveDraws& draws) const { return line(draws)(nees); }

 private:
  static constexpr std::size_t kFreedoms = 128;  // number of steps of 1 / freedom

  /// log2 of the chi-square of a column.
  double octave_of(std::size_t column) const;
  /// {chi-square} log2 of d F, for a step of 1 / freedom.
  const double* row(std::size_t step) const;

  double dimension_;
  double last_octave_;   ///< log2 of the chi-square beyond which the scale is linear
  std::size_t columns_;  ///< number of chi-square values, at equal steps of their logarithm
  /// {1 / freedom, chi-square} log2 of d F. Any thread computes a row when it is first needed,
  /// since studies need few of them.
  mutable std::vector<double> log_f_;
  mutable std::array<std::atomic<bool>, kFreedoms + 1> is_made_{};
  mutable std::mutex making_;
};

/// The scale for errors of 1 to 3 components, shared by all threads.
const SamplerScale& sampler_scale(std::size_t dimension);

}  // namespace montecarta::analysis
