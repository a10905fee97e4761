// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/convention_hints.hpp"

#include "analysis/metrics/nees.hpp"
#include "analysis/output/number_text.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <utility>

namespace montecarta::experiments {
namespace {

using analysis::ErrorBlock;
using analysis::Moments;
using analysis::NeesAccumulator;
using analysis::Verdict;

/// Whether the test of the verdict does not reject it.
bool fits_errors(const ConventionHint::Judged& judged) {
  const Verdict verdict = judged.consistency.verdict;
  return verdict == Verdict::consistent || verdict == Verdict::undecided;
}

std::string with_anees(const ConventionHint::Judged& judged) {
  return name_of(judged.convention) + " (ANEES " + analysis::compact(judged.consistency.mean) + ")";
}

}  // namespace

ConventionHints::ConventionHints(std::string cell, const StateShape& shape,
                                 const std::vector<double>& times)
    : cell_(std::move(cell)), times_(&times) {
  for (const ErrorConvention convention : conventions_of(shape.kind)) {
    conventions_.push_back(convention);
    nees_.emplace_back(ErrorBlock::pose, Moments::spread, times.size(), shape.dimension());
  }
}

void ConventionHints::add(const StateRows& rows, const std::vector<Eigen::VectorXd>& truths) {
  if (conventions_.size() < 2) return;
  std::vector<double> values(truths.size());
  for (std::size_t k = 0; k < conventions_.size(); ++k) {
    for (std::size_t s = 0; s < truths.size(); ++s) {
      const Eigen::VectorXd error = error_of(rows.shape, conventions_[k], rows.state[s], truths[s]);
      values[s] = analysis::strict_nees(error, rows.covariance[s]);
    }
    nees_[k].add(values);
  }
}

ConventionHint ConventionHints::result(double level, double within) const {
  ConventionHint hint{cell_, {}};
  if (conventions_.size() < 2) return hint;
  const analysis::BandWalks walks(times_->size());
  for (std::size_t k = 0; k < conventions_.size(); ++k) {
    hint.by_convention.push_back(
        {conventions_[k], nees_[k].result(*times_, level, walks, within).consistency});
  }
  return hint;
}

std::string in_words(const ConventionHint& hint, ErrorConvention said) {
  std::vector<std::string> fitting, others;
  bool said_fits = false;
  for (const ConventionHint::Judged& judged : hint.by_convention) {
    if (judged.consistency.verdict == Verdict::untested) return "";
    if (judged.convention == said) {
      said_fits = fits_errors(judged);
    } else {
      (fits_errors(judged) ? fitting : others).push_back(with_anees(judged));
    }
  }
  if (fitting.empty() && others.empty()) return "";
  std::string words = hint.cell + ": the verdict is by the error " + name_of(said) + ". ";
  if (fitting.empty())
    return words + "Every other would have been rejected as well: " + joined(others);
  words += "The same covariances would not have been rejected as " + joined(fitting);
  if (!others.empty()) words += ", but as " + joined(others);
  return words + (said_fits ? ": this study cannot tell them apart"
                            : ": were they meant so? If not, this is by chance, and no verdict");
}

}  // namespace montecarta::experiments
