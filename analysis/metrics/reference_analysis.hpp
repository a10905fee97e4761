// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/reference_scores.hpp"
#include "analysis/statistics/spread.hpp"

#include <cstddef>
#include <vector>

namespace montecarta::analysis {

/// The complete runs of a cell against one reference.
struct ReferenceAnalysis {
  std::vector<ReferenceScores> runs;    ///< {run}
  std::vector<double> error_over_time;  ///< [m] {fix} raw distance, RMS over runs

  Spread over_runs(double ReferenceScores::*score) const;
  /// Runs that lost the map.
  std::size_t lost() const;
  /// Runs whose aligned RMS is below `baseline` [m].
  std::size_t better_than(double baseline) const;
};

/// One for each reference of the drive, the leading first.
using ReferenceAnalyses = std::vector<ReferenceAnalysis>;

/// Adds up runs against one reference in the order of the calls. Memory depends on fixes, and grows
/// by a few numbers with every run.
class ReferenceAccumulator {
 public:
  void add(const ReferenceRun& run);
  ReferenceAnalysis result() const;

 private:
  std::vector<ReferenceScores> runs_;
  std::vector<double> squared_;  ///< [m^2] {fix} sum over runs
};

}  // namespace montecarta::analysis
