// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/convention_hints.hpp"

#include "analysis/output/number_text.hpp"

namespace montecarta::analysis {
namespace {

/// Whether the test of the verdict does not reject it.
bool fits_errors(const Consistency& found) {
  return found.verdict == Verdict::consistent || found.verdict == Verdict::undecided;
}

std::string comma_joined(const std::vector<std::string>& parts) {
  std::string all;
  for (const std::string& part : parts) all += (all.empty() ? "" : ", ") + part;
  return all;
}

}  // namespace

ConventionHints::ConventionHints(std::size_t components, std::size_t scans)
    : nees_(kErrorConventions.size(),
            NeesAccumulator(ErrorBlock::pose, Moments::spread, scans, components)) {}

void ConventionHints::add(const std::array<std::vector<double>, kErrorConventions.size()>& nees) {
  for (std::size_t k = 0; k < nees_.size(); ++k) nees_[k].add(nees[k]);
}

ConventionHint ConventionHints::result(std::span<const double> times, double level,
                                       const BandWalks& walks, double within) const {
  ConventionHint hint;
  for (const NeesAccumulator& nees : nees_)
    hint.by_convention.push_back(nees.result(times, level, walks, within).consistency);
  return hint;
}

std::string in_words(const ConventionHint& hint, const std::string& cell, const std::string& said) {
  std::vector<std::string> fitting, others;
  bool said_fits = false;
  for (std::size_t k = 0; k < hint.by_convention.size(); ++k) {
    const Consistency& found = hint.by_convention[k];
    if (found.verdict == Verdict::untested) return "";
    if (said == kErrorConventions[k].name) {
      said_fits = fits_errors(found);
    } else {
      (fits_errors(found) ? fitting : others)
          .push_back(std::string(kErrorConventions[k].name) + " (ANEES " + compact(found.mean) +
                     ")");
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
