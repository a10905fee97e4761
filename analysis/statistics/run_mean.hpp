// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/interval.hpp"
#include "analysis/statistics/spread.hpp"

namespace montecarta::analysis {

/// The expectation of a number that every run has, judged by the runs themselves: Student's t with
/// Hall's correction for skewness (P. Hall: On the removal of skewness by transformation, JRSS B
/// 54, 1992; STATISTICS 5). Runs are independent; nothing is assumed about the errors within a run.
class RunMean {
 public:
  /// Judges a mean of squared errors divided by the reported variances. It is skewed to the right
  /// at least as much as the gamma distribution with its mean and deviation. `common_skewness` is
  /// the skewness over all scans together, if the number belongs to one scan.
  static RunMean of_ratio(const Summary& runs, double common_skewness = 0.0);
  /// Judges a mean of products, which may be skewed to either side.
  static RunMean of_product(const Summary& runs);
  /// Judges a number with a symmetric distribution, by Student's t without correction.
  static RunMean of_symmetric(const Summary& runs);

  double mean() const { return runs_.mean; }
  /// The law of (number - `offset`) / `unit`, where `unit` is above zero.
  RunMean in_units_of(double unit, double offset = 0.0) const;
  /// Two-sided p-value of the expectation `expected`; 1 for fewer than three runs. A ratio is also
  /// rejected if a ratio kFar times nearer to `expected` would be rejected by the law of one
  /// Gaussian error that never changes within a run.
  double p_value(double expected) const;
  static constexpr double kFar = 4.0;
  /// One-sided p-value against an expectation of 0 or less.
  double p_value_above_zero() const;
  /// Interval that holds the expectation with probability `level`. An end is infinite where the
  /// runs exclude nothing; both are NaN for fewer than three runs.
  Interval interval(double level) const;

 private:
  RunMean(const Summary& runs, double above, double below, bool is_ratio)
      : runs_(runs), skewness_above_(above), skewness_below_(below), is_ratio_(is_ratio) {}
  /// A variable that has Student's distribution if `expected` is right.
  double score(double expected) const;
  /// The expectation that has this score.
  double expectation_at(double score) const;

  Summary runs_;
  /// Skewness of one run, for means above and below the expected one.
  double skewness_above_, skewness_below_;
  bool is_ratio_;
};

}  // namespace montecarta::analysis
