// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// A vector of a few components at equal steps: {component}{sample}, equally long.
using VectorSeries = std::vector<std::vector<double>>;

/// Squared Frobenius norm of the correlation matrix of samples `lag` steps apart about zero, over
/// components x (mean square)^2: 1 at lag 0 of a white series with equal components, at most 1 as
/// returned. {lag}, as many as samples. Correlations between two components count where they are
/// more than twice as large as by chance.
std::vector<double> squared_correlations(const VectorSeries& series);

/// Semivariance of each component: half of the mean squared difference of samples `lag` steps
/// apart. {component}{lag}
VectorSeries semivariances(const VectorSeries& series);

/// Number of independent samples with the same variance of the average of squares, if the
/// components are Gaussian with mean zero: n / (1 + 2 sum (1 - lag / n) squared correlation),
/// summed up to the first lag beyond five times the sum (A. Sokal: Monte Carlo methods in
/// statistical mechanics, 1997). In [1, n].
double effective_samples(std::span<const double> squared_correlations);

}  // namespace montecarta::analysis
