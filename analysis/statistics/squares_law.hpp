// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/nees_bounds.hpp"

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// Traces of R, R^2 and R^3, where R is the correlation matrix of the errors in a sum of squares.
/// Up to factors they are the cumulants of the sum, for any correlations between the errors
/// (STATISTICS 5).
struct Traces {
  double first = 0.0;
  double second = 0.0;
  double third = 0.0;
  /// Degrees of freedom of `second`, which is estimated; infinite where it is a bound.
  double freedom = std::numeric_limits<double>::infinity();
};

/// Studies of fewer runs are not judged.
inline constexpr std::size_t kFewestJudgedRuns = 3;

/// Studies of fewer runs are judged by the law of errors that never change within a run.
inline constexpr std::size_t kFewestRunsOfTraces = 20;

/// Scalar products of the errors of every two runs: symmetric, {run, run}.
class RunProducts {
 public:
  explicit RunProducts(std::size_t runs) : runs_(runs), products_(runs * runs) {}

  /// Adds the products of `rows` {run, length}. The same bits on every processor.
  void add(std::span<const double> rows, std::size_t length);
  void add(const RunProducts& other);

  std::size_t runs() const { return runs_; }
  double operator()(std::size_t i, std::size_t j) const { return products_[i * runs_ + j]; }
  /// Sum over j of the squared products of run i with run j, itself excepted.
  double squares_with_others(std::size_t i) const;
  /// Sum of G_ij G_jk G_ki over distinct i, j and k.
  double cycles() const;

 private:
  std::size_t runs_;
  std::vector<double> products_;
};

/// Mean of G_ij^2 over different runs i and j, its standard deviation by the jackknife, and the
/// same mean without each of the runs {run}.
struct MeanSquaredProduct {
  double mean = 0.0;
  double deviation = 0.0;
  std::vector<double> without;
};

/// Needs at least three runs.
MeanSquaredProduct mean_squared_product(const RunProducts& products);

/// Traces of sums of `terms` squared errors, by the products of errors that were divided by their
/// root mean square over the runs, scan by scan. `largest` is the second trace of errors that never
/// change within a run; `share` of the terms that one run has another one has as well.
Traces traces_of(const RunProducts& products, double terms, double largest, double share);

/// Traces of errors that never change within a run: with `largest` as the second one.
Traces traces_of_constant_errors(double terms, double largest);

/// Law of the mean over runs of such a sum, divided by its expectation: the shifted gamma
/// distribution with the cumulants that the traces give. Normal scores of it are compared with
/// Student's t, since the second trace is estimated.
class SquaresLaw {
 public:
  SquaresLaw(const Traces& traces, double runs);

  /// Two-sided p-value of a mean that is `ratio` times the expected one.
  double p_value(double ratio) const;
  /// Interval that holds the true ratio with probability `level` where the mean is `ratio` times
  /// the expected one.
  Interval interval(double ratio, double level) const;
  /// Quantile of the ratio of a consistent filter at a normal score, Student's t not applied.
  double quantile(double score) const;

 private:
  double score(double ratio) const;

  double freedom_;
  double shape_, scale_, shift_;
};

}  // namespace montecarta::analysis
