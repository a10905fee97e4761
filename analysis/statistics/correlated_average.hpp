// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/correlation.hpp"
#include "analysis/statistics/nees_bounds.hpp"

#include <cstddef>
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

/// What the NEES along one drive says (STATISTICS 20).
struct CorrelatedAverage {
  double mean = 0.0;               ///< average NEES divided by the components: 1 is expected
  double effective_samples = 0.0;  ///< independent ones with an average that varies as much
  Interval ratio = {};             ///< where the expected average of all such drives lies, over
                                   ///< the components
};

/// Of `errors` in units of the covariance, {component}{sample} in the order of time: an error of
/// covariance P times the inverse of the Cholesky factor of P, so that their squares add up to the
/// NEES. If the filter is consistent they are Gaussian with mean zero and covariance one, and go
/// together for any time, up to all of the drive. The interval then excludes 1 in at most 1 -
/// `level` of all drives. Throws StudyError where level is not inside (0, 1); there must be a
/// component and a sample.
CorrelatedAverage correlated_average(const VectorSeries& errors, double level);

/// Of several independent drives of as many components, at least one: the average over drives of
/// their averages, whatever their lengths. Of one drive as above.
CorrelatedAverage correlated_average(std::span<const VectorSeries> drives, double level);

/// How many effective samples make that interval so short that its ends have a ratio of at most
/// `within`, so that it excludes 1 or is inside [1 / within, within]; infinite where more than 1e9.
double samples_that_decide(std::size_t dimension, double level, double within);

}  // namespace montecarta::analysis
