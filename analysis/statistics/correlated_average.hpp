// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/interval.hpp"

#include <cstddef>
#include <span>
#include <tuple>
#include <vector>

namespace montecarta::analysis {

/// A vector of a few components at equal steps: {component}{sample}, equally long.
using VectorSeries = std::vector<std::vector<double>>;

/// {lag} Squared Frobenius norm of the correlation matrix (about zero) of samples `lag` steps
/// apart, divided by components x (mean square)^2; as many lags as samples. The value is 1 at lag
/// 0, at most 1 elsewhere, and 1 everywhere if the series is zero. Lags above 128 are partly
/// interpolated. Correlations between two components count only where they are more than twice as
/// large as chance makes them.
std::vector<double> squared_correlations(const VectorSeries& series);

/// {component}{lag} Semivariance: half of the mean squared difference of samples `lag` steps apart.
VectorSeries semivariances(const VectorSeries& series);

/// Number of independent samples for which the average of squares has the same variance, if the
/// components are Gaussian with mean zero: n / (1 + 2 sum (1 - lag / n) squared correlation),
/// summed up to the first lag beyond five times the sum (A. Sokal: Monte Carlo methods in
/// statistical mechanics, 1997). In [1, n].
double effective_samples(std::span<const double> squared_correlations);

/// A chi-square variable with `count` degrees of freedom, which need not be whole, times `weight`
/// >= 0.
struct WeightedSquares {
  double weight = 0.0;
  double count = 1.0;
};

/// Probability that the sum of independent `terms` is at most `x`, by saddlepoint approximation
/// (D. Kuonen: Saddlepoint approximations for distributions of quadratic forms in normal variables,
/// Biometrika 86, 1999): to 0.01, and in the tails to a few per cent. At least one weight must be
/// above 0.
double probability_below(std::span<const WeightedSquares> terms, double x);

/// Test of the NEES along one drive (STATISTICS 20).
struct CorrelatedAverage {
  double mean = 0.0;  ///< average NEES divided by the number of components; its expectation is 1
  double effective_samples = 0.0;  ///< number of independent samples whose average varies as much
  /// Interval of the expected average over all such drives, divided by the number of components.
  Interval ratio = {};
  static constexpr auto members() {
    using Average = CorrelatedAverage;
    return std::tuple(&Average::mean, &Average::effective_samples, &Average::ratio);
  }
};

/// Tests whitened `errors` {component}{sample} in the order of time: the inverse of the Cholesky
/// factor of the covariance times the error, so that the sum of squares is the NEES. For a
/// consistent filter they are Gaussian with mean zero and covariance one, and correlated for any
/// time up to the whole drive. The interval then excludes 1 in at most 1 - `level` of all drives.
/// Throws StudyError if level is not inside (0, 1); there must be a component and a sample.
CorrelatedAverage correlated_average(const VectorSeries& errors, double level);

/// Tests the mean of the averages of one or more independent drives with equal numbers of
/// components. Drives of all lengths count alike.
CorrelatedAverage correlated_average(std::span<const VectorSeries> drives, double level);

/// Two-sided p-value of the hypothesis that the expected average of these drives is 1: the level
/// 1 - p is the largest at which the interval excludes it.
double p_value_of_one(std::span<const VectorSeries> drives);

/// Number of effective samples at which the ratio of the interval's ends is at most `within`: the
/// interval then excludes 1 or lies in [1 / within, within]. Infinite if it is more than 1e9.
double samples_that_decide(std::size_t dimension, double level, double within);

}  // namespace montecarta::analysis
