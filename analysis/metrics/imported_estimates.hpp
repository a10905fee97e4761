// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/data/run_rows.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "analysis/verdict/summed_error.hpp"
#include "analysis/verdict/verdict.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// The imported state by the settings of a cell, if 'montecarta judge' made the file; else the pose
/// in the plane.
ImportedState imported_state(const StoredCell& cell);

/// "x, y, heading".
std::string components_text(const StudyAnalysis& study);

/// Notes on imported estimates: the convention of the error, and the number of unusable covariances
/// of each cell. Empty for filters of ours.
std::vector<std::string> imported_notes(const StudyAnalysis& study);

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
