// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

namespace montecarta::analysis {

/// Puts the NEES by the spread of particles on the scale of the chi-square. If the particles are
/// independent draws from the distribution that the truth was drawn from, that NEES is
/// d (M + 1) / (M - d) times an F variable with d and M - d degrees of freedom (Hotelling;
/// STATISTICS 4), far larger than a chi-square where M is small. What is as probable under the F as
/// some value under the chi-square becomes that value: of such an ideal sampler the result is
/// chi-square exactly.
class SamplerScale {
 public:
  /// `particles` > `dimension`.
  SamplerScale(std::size_t dimension, std::size_t particles);

  std::size_t particles() const { return particles_; }
  /// `nees` >= 0, to two parts in ten thousand (a table); NaN stays NaN.
  double operator()(double nees) const;

 private:
  std::size_t particles_;
  std::vector<double> log_ratios_;  ///< [log2] of result to argument, at equal steps of log2(nees)
};

}  // namespace montecarta::analysis
