// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/reference_scores.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/statistics/sums.hpp"
#include "analysis/study/cell_analysis.hpp"
#include "analysis/study/frame.hpp"
#include "analysis/study/study_analysis.hpp"

#include <cstddef>
#include <string>
#include <tuple>
#include <vector>

namespace montecarta::analysis {

/// Comparison of the complete runs of a cell with one reference.
struct ReferenceAnalysis {
  std::vector<ReferenceScores> runs;  ///< {run} scores of each run
  /// [m] {fix} RMS raw distance over runs; empty if runs are drives of their own.
  std::vector<double> error_over_time;

  /// Summary of a score over the runs with fixes.
  Spread over_runs(double ReferenceScores::*score) const;
  /// Number of runs with fixes; a run's own drive may have none.
  std::size_t with_fixes() const;
  /// Number of runs that lost the map.
  std::size_t lost() const;
};

/// {reference of the drive} comparisons, the leading one first.
using ReferenceAnalyses = std::vector<ReferenceAnalysis>;

/// Adds up runs against one reference in the order of the calls. Memory depends on fixes, and grows
/// by a few numbers with every run.
class ReferenceAccumulator {
 public:
  /// Whether all runs have the same fixes, so that errors are added up fix by fix, or each run its
  /// own.
  enum class Fixes { same, own };
  explicit ReferenceAccumulator(Fixes fixes = Fixes::same) : fixes_(fixes) {}
  void add(const ReferenceRun& run);
  ReferenceAnalysis result() const;
  static constexpr auto parts() {
    return std::tuple(added(&ReferenceAccumulator::squared_),
                      appended(&ReferenceAccumulator::runs_));
  }

 private:
  Fixes fixes_;
  std::vector<ReferenceScores> runs_;
  std::vector<double> squared_;  ///< [m^2] {fix} sum of squared distances over runs
};

/// The reason why a recorded drive has no verdict on consistency.
std::string no_truth_sentence(const StudyAnalysis& study);

/// The baseline: the first cell with the filter ekf_slam and complete runs; nullptr if there is
/// none.
const CellAnalysis* baseline_of(const StudyAnalysis& study);

/// Numbers of runs that are better than a baseline, and that equal it.
struct RunsAgainst {
  std::size_t better = 0, equal = 0;
};

/// Whether all runs process the same drive, or each its own.
enum class DrivesOfRuns { same, own };

/// Compares the runs of a cell with those of `baseline`, by a score against the leading reference.
/// Runs on the same drive are compared with the mean over the baseline's runs, runs on drives of
/// their own with the baseline's run on that drive. A run that the baseline failed is better.
/// Scores that differ by rounding alone are equal.
RunsAgainst runs_against(const CellAnalysis& cell, const CellAnalysis& baseline,
                         double ReferenceScores::*score, DrivesOfRuns drives);

/// Numbers of a cell for one reference, with their names in files: mean, standard error, median,
/// least and greatest of each over runs; and the numbers of its maps.
Frame::Row reference_numbers(const CellAnalysis& cell, std::size_t reference);

}  // namespace montecarta::analysis
