// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/run_rows.hpp"
#include "analysis/statistics/sums.hpp"
#include "analysis/verdict/layout_mistakes.hpp"
#include "analysis/verdict/summed_error.hpp"
#include "analysis/verdict/verdict.hpp"
#include "engine/records/columns.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace montecarta::analysis {

/// The mistakes in the layout of a covariance after whose correction errors are tested.
inline constexpr std::array kTestedMistakes = {LayoutMistake::rotation_first,
                                               LayoutMistake::degrees, LayoutMistake::radians};

/// Verdicts on the imported estimates of a cell, one for each convention of the error and one for
/// each mistake in the layout.
struct ConventionHint {
  /// {kErrorConventions} verdicts, untested for conventions that do not apply.
  std::vector<Verdict> by_convention;
  /// {kTestedMistakes} verdicts under the stated convention, untested for mistakes that do not
  /// apply.
  std::vector<Verdict> by_mistake = {};
  LayoutMistakes mistakes = {};  ///< how near they bring the variances to the errors
};

/// NEES by convention or by mistake, and then by scan; empty where it does not apply.
template <std::size_t N>
using NeesBy = std::array<std::vector<double>, N>;

/// {kTestedMistakes}{scan} The NEES of imported errors whose components have these units, if the
/// layout of their covariances has the mistake.
NeesBy<kTestedMistakes.size()> nees_by_mistake(const ErrorRows& errors,
                                               std::span<const std::string> units);

/// Adds up the NEES of runs under every convention and every mistake.
class ConventionHints {
 public:
  ConventionHints() = default;  ///< empty sums, to be filled by a SumReader
  /// Makes sums for errors of `components` components at `scans` scans.
  ConventionHints(std::size_t components, std::size_t scans);

  /// Adds the NEES of one run.
  void add(const NeesBy<kErrorConventions.size()>& by_convention,
           const NeesBy<kTestedMistakes.size()>& by_mistake = {});
  /// Adds the variances of one run, whose components have these units.
  void add_variances(const ErrorRows& errors, std::span<const std::string> units) {
    mistakes_.add(errors, units);
  }
  /// Verdicts by size and scans at `level`; `times` [s] of the scans.
  ConventionHint result(std::span<const double> times, double level, double within) const;
  static constexpr auto parts() {
    return std::tuple(
        settings(&ConventionHints::components_),
        added(&ConventionHints::runs_, &ConventionHints::nees_, &ConventionHints::mistakes_));
  }

 private:
  double components_ = 0.0;
  std::uint64_t runs_ = 0;
  /// {kErrorConventions, then kTestedMistakes} sums of the NEES
  std::vector<SummedError> nees_;
  LayoutMistakes mistakes_;
};

/// A text that names the conventions other than `said` that fit the covariances of `cell`, those
/// that do not, and the mistakes that would explain errors that do not fit, or bring them far
/// nearer to their variances. Empty if nothing was tested. If only the verdict, which has more
/// tests, refutes the stated convention (`is_refuted`), what the hint does not reject may be
/// refuted likewise, and is not named.
std::string in_words(const ConventionHint& hint, const std::string& cell, const std::string& said,
                     bool is_refuted = false);

}  // namespace montecarta::analysis
