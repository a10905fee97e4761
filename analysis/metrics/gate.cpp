// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/gate.hpp"

#include "analysis/output/number_text.hpp"
#include "engine/errors.hpp"

#include <cmath>

namespace montecarta::analysis {
namespace {

/// "; ANEES 0.97 to 1.08 times the expected one, 200 runs"
std::string numbers_behind(const Consistency& found) {
  std::string words = "; ";
  if (std::isfinite(found.ratio.lower) && std::isfinite(found.ratio.upper)) {
    words += "ANEES " + compact(found.ratio.lower) + " to " + compact(found.ratio.upper) +
             " times the expected one, ";
  }
  return words + std::to_string(found.runs) + " runs";
}

/// Whether ratios within the margin are left: then more runs may show the filter to be.
bool may_be_within(const Consistency& found) {
  return found.ratio.lower < found.within && found.ratio.upper > 1.0 / found.within;
}

}  // namespace

Gate gate(const Consistency& found, const Allowance& allowed) {
  const std::string numbers = numbers_behind(found);
  const std::string margin = " within " + exact_text(found.within);
  if (found.failed > allowed.failed || found.unusable > allowed.unusable) {
    const bool by_runs = found.failed > allowed.failed;
    return {GateAnswer::inconsistent,
            "not consistent, more " + std::string(by_runs ? "failed runs" : "unusable samples") +
                " than are allowed (" +
                std::to_string(by_runs ? allowed.failed : allowed.unusable) +
                "): " + in_words(found) + numbers};
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
