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

/// The complete runs of a cell against one reference.
struct ReferenceAnalysis {
  std::vector<ReferenceScores> runs;  ///< {run}
  /// [m] {fix} raw distance, RMS over runs; empty where runs are drives of their own.
  std::vector<double> error_over_time;

  /// A score over the runs with fixes.
  Spread over_runs(double ReferenceScores::*score) const;
  /// Number of runs with fixes; a drive of a run's own may have none.
  std::size_t with_fixes() const;
  /// Number of runs that lost the map.
  std::size_t lost() const;
  /// Number of runs with a `score` below `baseline` [m].
  std::size_t better_than(double baseline, double ReferenceScores::*score) const;
};

/// One for each reference of the drive, the leading first.
using ReferenceAnalyses = std::vector<ReferenceAnalysis>;

/// Adds up runs against one reference in the order of the calls. Memory depends on fixes, and grows
/// by a few numbers with every run.
class ReferenceAccumulator {
 public:
  /// `same`: all runs have the same fixes, and errors are added up fix by fix; `own`: they have
  /// not.
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
  std::vector<double> squared_;  ///< [m^2] {fix} sum over runs
};

/// Why a recorded drive has no verdict on consistency.
std::string no_truth_sentence(const StudyAnalysis& study);

/// The baseline: the first cell of the filter ekf_slam with complete runs; nullptr if there is
/// none.
const CellAnalysis* baseline_of(const StudyAnalysis& study);

/// Numbers of a cell for one reference, named as in files: each over runs as mean, standard error,
/// median, least and greatest; and the numbers of its maps.
Frame::Row reference_numbers(const CellAnalysis& cell, std::size_t reference);

}  // namespace montecarta::analysis
