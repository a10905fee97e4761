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

/// What a cell of a file that 'montecarta judge' made says of its state, by its settings; the pose
/// in the plane of all other cells.
ImportedState imported_state(const StoredCell& cell);

/// "x, y, heading".
std::string components_text(const StudyAnalysis& study);

/// Of imported estimates, one sentence each: in which convention the error is, and of each cell how
/// many covariances were no covariances. Empty for filters of ours.
std::vector<std::string> imported_notes(const StudyAnalysis& study);

/// What imported estimates of a cell would be by each convention of their error.
struct ConventionHint {
  std::vector<Verdict> by_convention;  ///< {kErrorConventions}; empty where there is one only
};

/// Adds up runs by every convention.
class ConventionHints {
 public:
  /// Of errors of so many components at so many scans.
  ConventionHints(std::size_t components, std::size_t scans);

  /// One run: {kErrorConventions}{scan}.
  void add(const std::array<std::vector<double>, kErrorConventions.size()>& nees);
  /// Judged by size and scans at `level`; `times` [s] of the scans.
  ConventionHint result(std::span<const double> times, double level, double within) const;

 private:
  double components_;
  std::uint64_t runs_ = 0;
  std::vector<SummedError> nees_;  ///< {kErrorConventions}
};

/// What a user should hear besides the verdict on `cell` by `said`: which other conventions fit the
/// same covariances and which do not. Empty where nothing can be said.
std::string in_words(const ConventionHint& hint, const std::string& cell, const std::string& said);

}  // namespace montecarta::analysis
