// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/reference_scores.hpp"
#include "analysis/statistics/spread.hpp"

#include <cstddef>
#include <vector>

namespace montecarta::analysis {

/// The complete runs of a cell against one reference.
struct ReferenceAnalysis {
  std::vector<ReferenceScores> runs;  ///< {run}
  /// [m] {fix} raw distance, RMS over runs; empty where runs are drives of their own.
  std::vector<double> error_over_time;

  /// Of the runs with fixes.
  Spread over_runs(double ReferenceScores::*score) const;
  /// How many runs have fixes: drives of their own may have none.
  std::size_t with_fixes() const;
  /// Runs that lost the map.
  std::size_t lost() const;
  /// Runs whose `score` is below `baseline` [m].
  std::size_t better_than(double baseline, double ReferenceScores::*score) const;
};

/// One for each reference of the drive, the leading first.
using ReferenceAnalyses = std::vector<ReferenceAnalysis>;

/// Adds up runs against one reference in the order of the calls. Memory depends on fixes, and grows
/// by a few numbers with every run.
class ReferenceAccumulator {
 public:
  /// `fixes`: of runs that all met the same; else their errors are not added up fix by fix.
  enum class Fixes { same, own };
  explicit ReferenceAccumulator(Fixes fixes = Fixes::same) : fixes_(fixes) {}
  void add(const ReferenceRun& run);
  ReferenceAnalysis result() const;

 private:
  Fixes fixes_;
  std::vector<ReferenceScores> runs_;
  std::vector<double> squared_;  ///< [m^2] {fix} sum over runs
};

}  // namespace montecarta::analysis
