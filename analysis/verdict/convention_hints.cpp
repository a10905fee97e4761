// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/convention_hints.hpp"

#include "analysis/run/nees.hpp"
#include "engine/text/list_text.hpp"
#include "engine/text/number_text.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {
namespace {

/// Returns whether no family rejects that the errors are consistent.
bool fits_errors(const Verdict& found) {
  return std::ranges::none_of(found.families, &FamilyTest::is_rejected);
}

/// {scan} NEES of errors whose covariances are corrected.
template <class Correct>
std::vector<double> nees_with(const ErrorRows& errors, const Correct& correct) {
  std::vector<double> nees;
  for (std::size_t s = 0; s < errors.scans(); ++s) {
    const Nees sample = imported_nees(errors.error(s), correct(errors.covariance_of(s)));
    nees.push_back(on_full_scale(sample, errors.components()));
  }
  return nees;
}

std::string with_ratio(const std::string& name, const Verdict& found) {
  if (std::isnan(found.ratio_estimate())) return name;  // of too few runs
  return name + " (NEES ratio " + compact(found.ratio_estimate()) + ")";
}

/// The mistakes that would explain why the errors do not fit as stated.
std::string mistakes_in_words(const ConventionHint& hint) {
  std::vector<std::string> fitting;
  for (std::size_t k = 0; k < hint.by_mistake.size(); ++k) {
    const Verdict& found = hint.by_mistake[k];
    if (found.answer == Answer::untested || !fits_errors(found)) continue;
    fitting.push_back(with_ratio(name_of(kTestedMistakes[k]), found));
  }
  if (fitting.empty()) return in_words(hint.mistakes);
  return "The covariances may be written with " + joined(fitting) +
         ", by which they would not have been rejected";
}

/// A clause on the rejected conventions whose NEES ratio is far nearer to 1 than the stated one;
/// empty without any.
std::string far_nearer_in_words(const ConventionHint& hint, const std::string& said) {
  const auto distance = [&](std::size_t k) {
    return std::abs(std::log(hint.by_convention[k].ratio_estimate()));
  };
  std::size_t stated = 0;
  while (stated < hint.by_convention.size() && kErrorConventions[stated].name != said) ++stated;
  if (stated == hint.by_convention.size()) return "";
  std::vector<std::string> nearer;
  for (std::size_t k = 0; k < hint.by_convention.size(); ++k) {
    const Verdict& found = hint.by_convention[k];
    if (found.answer == Answer::untested || fits_errors(found)) continue;
    if (std::isfinite(distance(k)) && distance(k) <= distance(stated) - std::log(kFarNearer))
      nearer.emplace_back(kErrorConventions[k].name);
  }
  if (nearer.empty()) return "";
  return "; far nearer to 1 than the ratio " +
         compact(hint.by_convention[stated].ratio_estimate()) + " of " + said + " is that of " +
         joined(nearer);
}

}  // namespace

NeesBy<kTestedMistakes.size()> nees_by_mistake(const ErrorRows& errors,
                                               std::span<const std::string> units) {
  NeesBy<kTestedMistakes.size()> nees;
  if (units.size() != errors.components()) return nees;
  for (std::size_t k = 0; k < nees.size(); ++k) {
    const LayoutCorrection correction = correction_of(kTestedMistakes[k], units);
    if (correction.from.empty()) continue;
    nees[k] = nees_with(errors, [&](const Eigen::MatrixXd& P) { return correction.covariance(P); });
  }
  return nees;
}

ConventionHints::ConventionHints(std::size_t components, std::size_t scans)
    : components_(static_cast<double>(components)),
      nees_(kErrorConventions.size() + kTestedMistakes.size(), SummedError(scans)) {}

void ConventionHints::add(const NeesBy<kErrorConventions.size()>& by_convention,
                          const NeesBy<kTestedMistakes.size()>& by_mistake) {
  ++runs_;
  for (std::size_t k = 0; k < nees_.size(); ++k) {
    const std::vector<double>& nees =
        k < by_convention.size() ? by_convention[k] : by_mistake[k - by_convention.size()];
    if (!nees.empty()) nees_[k].add(nees, components_);
  }
}

ConventionHint ConventionHints::result(std::span<const double> times, double level,
                                       double within) const {
  ConventionHint hint;
  for (std::size_t k = 0; k < nees_.size(); ++k) {
    (k < kErrorConventions.size() ? hint.by_convention : hint.by_mistake)
        .push_back(judge(nees_[k].families(level, times), level, within, runs_));
  }
  hint.mistakes = mistakes_;
  return hint;
}

std::string in_words(const ConventionHint& hint, const std::string& cell, const std::string& said,
                     bool is_refuted) {
  std::vector<std::string> fitting, others;
  bool said_fits = false;
  for (std::size_t k = 0; k < hint.by_convention.size(); ++k) {
    const Verdict& found = hint.by_convention[k];
    const char* name = kErrorConventions[k].name;
    if (found.answer == Answer::untested) {
      if (said == name) return "";
    } else if (said == name) {
      said_fits = fits_errors(found);
    } else {
      (fits_errors(found) ? fitting : others).push_back(with_ratio(name, found));
    }
  }
  // Size and scans of a few runs may not show a part that is far too small, which sums of it do.
  const std::string mistakes = said_fits ? in_words(hint.mistakes) : mistakes_in_words(hint);
  if (said_fits && is_refuted) fitting = others = {};
  if (fitting.empty() && others.empty() && mistakes.empty()) return "";
  std::string words = cell + ": the verdict is by the error " + said + ". ";
  if (fitting.empty() && others.empty()) return words + mistakes;
  if (fitting.empty()) {
    words += "Every other would have been rejected";
    words += said_fits ? ": " : " as well: ";
    words += joined(others);
  } else {
    words += "The same covariances would pass as " + joined(fitting);
    if (!others.empty()) words += ", and be rejected as " + joined(others);
    words += said_fits ? ": this study cannot tell those that pass apart"
                       : ": are they of another error than was said? If not, they pass by chance";
  }
  if (!said_fits) words += far_nearer_in_words(hint, said);
  return mistakes.empty() ? words : words + ". " + mistakes;
}

}  // namespace montecarta::analysis
