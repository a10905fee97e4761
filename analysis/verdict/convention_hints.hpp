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

/// Verdicts on the imported estimates of a cell under each convention of their error.
struct ConventionHint {
  std::vector<Verdict> by_convention;  ///< {kErrorConventions}; empty if only one applies
};

/// Adds up the NEES of runs under every convention.
class ConventionHints {
 public:
  ConventionHints() = default;  ///< to be read
  /// Sums for errors of `components` at `scans`.
  ConventionHints(std::size_t components, std::size_t scans);

  /// One run: {kErrorConventions}{scan}.
  void add(const std::array<std::vector<double>, kErrorConventions.size()>& nees);
  /// Judged by size and scans at `level`; `times` [s] of the scans.
  ConventionHint result(std::span<const double> times, double level, double within) const;
  static constexpr auto parts() {
    return std::tuple(settings(&ConventionHints::components_),
                      added(&ConventionHints::runs_, &ConventionHints::nees_));
  }

 private:
  double components_ = 0.0;
  std::uint64_t runs_ = 0;
  std::vector<SummedError> nees_;  ///< {kErrorConventions}
};

/// The conventions other than `said` that fit the covariances of `cell`, and those that do not.
/// Empty if none was tested.
std::string in_words(const ConventionHint& hint, const std::string& cell, const std::string& said);

}  // namespace montecarta::analysis
