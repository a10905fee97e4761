// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/nees_accumulator.hpp"
#include "experiments/judging/judged_study.hpp"

#include <string>
#include <vector>

namespace montecarta::experiments {

/// Judges the estimates of one cell by every convention that their state has, run by run.
class ConventionHints {
 public:
  /// `times` [s] of all runs, which must outlive it.
  ConventionHints(std::string cell, const StateShape& shape, const std::vector<double>& times);

  /// One run: estimates and the truths {row} at their times.
  void add(const StateRows& rows, const std::vector<Eigen::VectorXd>& truths);
  ConventionHint result(double level, double within) const;

 private:
  std::string cell_;
  const std::vector<double>* times_;
  std::vector<ErrorConvention> conventions_;
  std::vector<analysis::NeesAccumulator> nees_;  ///< one for each
};

/// What a user should hear besides the verdict by `said`, a sentence: which other conventions fit
/// and which do not. Empty where the state has one convention only.
std::string in_words(const ConventionHint& hint, ErrorConvention said);

}  // namespace montecarta::experiments
