// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/gate.hpp"

#include "analysis/output/number_text.hpp"
#include "engine/errors.hpp"

#include <cmath>

namespace montecarta::analysis {
namespace {

/// ": ANEES 0.97 to 1.08 times the expected one, 200 runs"
std::string numbers_behind(const Consistency& found, const JudgedRuns& runs) {
  std::string words;
  if (std::isfinite(found.ratio.lower) && std::isfinite(found.ratio.upper)) {
    words = "ANEES " + compact(found.ratio.lower) + " to " + compact(found.ratio.upper) +
            " times the expected one, ";
  }
  words += std::to_string(runs.complete) + " complete runs";
  if (runs.failed > 0) words += ", " + std::to_string(runs.failed) + " failed";
  if (runs.unjudged > 0) words += ", " + std::to_string(runs.unjudged) + " without any NEES";
  if (runs.invalid == 0) return words;
  return words + "; " + std::to_string(runs.invalid) + " of " + std::to_string(runs.covariances) +
         " covariances are invalid and left out";
}

/// Whether ratios within the margin are left: then more runs may show the filter to be.
bool may_be_within(const Consistency& found) {
  return found.ratio.lower < found.within && found.ratio.upper > 1.0 / found.within;
}

}  // namespace

Gate gate(const Consistency& found, const JudgedRuns& runs) {
  const std::string numbers = "; " + numbers_behind(found, runs);
  const std::string margin = " within " + exact_text(found.within);
  if (found.verdict != Verdict::untested && runs.failed + runs.unjudged > runs.most_failed) {
    return {GateAnswer::inconsistent, std::to_string(runs.failed + runs.unjudged) + " of " +
                                          std::to_string(runs.complete + runs.failed) +
                                          " runs failed or have no NEES"};
  }
  switch (found.verdict) {
    case Verdict::untested:
      throw StudyError(
          "no NEES to judge (no complete run, no covariance, or too few effective draws at all "
          "scans): make more runs, have covariance in record.columns, or take more particles");
    case Verdict::consistent:
      return {GateAnswer::consistent, in_words(found) + numbers};
    case Verdict::undecided:
      return {GateAnswer::undecided,
              "not known to be consistent" + margin + ", " + in_words(found) + numbers};
    case Verdict::optimistic:
    case Verdict::conservative:
      break;
  }
  const bool both = may_be_within(found);
  return {GateAnswer::inconsistent, "not consistent, " + in_words(found) +
                                        (both ? ", though it may lie" + margin : "") + numbers};
}

}  // namespace montecarta::analysis
