// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/sums.hpp"
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

/// Verdicts on the imported estimates of a cell, one for each convention of the error.
struct ConventionHint {
  /// {kErrorConventions} verdicts; empty if only one convention applies.
  std::vector<Verdict> by_convention;
};

/// Adds up the NEES of runs under every convention.
class ConventionHints {
 public:
  ConventionHints() = default;  ///< empty sums, to be filled by a SumReader
  /// Makes sums for errors of `components` components at `scans` scans.
  ConventionHints(std::size_t components, std::size_t scans);

  /// Adds the NEES {kErrorConventions}{scan} of one run.
  void add(const std::array<std::vector<double>, kErrorConventions.size()>& nees);
  /// Verdicts by size and scans at `level`; `times` [s] of the scans.
  ConventionHint result(std::span<const double> times, double level, double within) const;
  static constexpr auto parts() {
    return std::tuple(settings(&ConventionHints::components_),
                      added(&ConventionHints::runs_, &ConventionHints::nees_));
  }

 private:
  double components_ = 0.0;
  std::uint64_t runs_ = 0;
  std::vector<SummedError> nees_;  ///< {kErrorConventions} sums of the NEES
};

/// A text that names the conventions other than `said` that fit the covariances of `cell`, and
/// those that do not. Empty if none was tested.
std::string in_words(const ConventionHint& hint, const std::string& cell, const std::string& said);

}  // namespace montecarta::analysis
