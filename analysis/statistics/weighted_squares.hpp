// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

namespace montecarta::analysis {

/// A chi-square of `count` degrees of freedom, not always whole, times `weight` >= 0.
struct WeightedSquares {
  double weight = 0.0;
  double count = 1.0;
};

/// Probability that the sum of independent `terms` is at most `x`, by saddlepoint approximation
/// (D. Kuonen: Saddlepoint approximations for distributions of quadratic forms in normal variables,
/// Biometrika 86, 1999): to 0.01, and in the tails to a few per cent. At least one weight must be
/// above 0.
double probability_below(std::span<const WeightedSquares> terms, double x);

}  // namespace montecarta::analysis
