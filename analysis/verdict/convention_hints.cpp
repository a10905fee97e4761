// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/convention_hints.hpp"

#include "engine/text/number_text.hpp"

#include <algorithm>

namespace montecarta::analysis {
namespace {

/// Returns whether no family rejects that the errors are consistent.
bool fits_errors(const Verdict& found) {
  return std::ranges::none_of(found.families, &FamilyTest::is_rejected);
}

std::string comma_joined(const std::vector<std::string>& parts) {
  std::string all;
  for (const std::string& part : parts) all += (all.empty() ? "" : ", ") + part;
  return all;
}

}  // namespace

ConventionHints::ConventionHints(std::size_t components, std::size_t scans)
    : components_(static_cast<double>(components)),
      nees_(kErrorConventions.size(), SummedError(scans)) {}

void ConventionHints::add(const std::array<std::vector<double>, kErrorConventions.size()>& nees) {
  ++runs_;
  for (std::size_t k = 0; k < nees_.size(); ++k) {
    if (!nees[k].empty()) nees_[k].add(nees[k], components_);
  }
}

ConventionHint ConventionHints::result(std::span<const double> times, double level,
                                       double within) const {
  ConventionHint hint;
  for (const SummedError& nees : nees_) {
    hint.by_convention.push_back(judge(nees.families(level, times), level, within, runs_));
  }
  return hint;
}

std::string in_words(const ConventionHint& hint, const std::string& cell, const std::string& said) {
  std::vector<std::string> fitting, others;
  bool said_fits = false;
  for (std::size_t k = 0; k < hint.by_convention.size(); ++k) {
    const Verdict& found = hint.by_convention[k];
    if (found.answer == Answer::untested) return "";
    if (said == kErrorConventions[k].name) {
      said_fits = fits_errors(found);
    } else {
      (fits_errors(found) ? fitting : others)
          .push_back(std::string(kErrorConventions[k].name) + " (NEES ratio " +
                     compact(found.ratio_estimate()) + ")");
    }
  }
  if (fitting.empty() && others.empty()) return "";
  std::string words = cell + ": the verdict is by the error " + said + ". ";
  if (fitting.empty())
    return words + "Every other would have been rejected" + (said_fits ? ": " : " as well: ") +
           comma_joined(others);
  words += "The same covariances would not have been rejected as " + comma_joined(fitting);
  if (!others.empty()) words += ", but as " + comma_joined(others);
  return words + (said_fits ? ": this study cannot tell them apart"
                            : ": were they meant so? If not, this is by chance, and no verdict");
}

}  // namespace montecarta::analysis
