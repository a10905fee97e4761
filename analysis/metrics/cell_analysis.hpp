// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/bound/efficiency.hpp"
#include "analysis/calibration/cell_calibration.hpp"
#include "analysis/joint/joint_nees.hpp"
#include "analysis/map/map_errors.hpp"
#include "analysis/metrics/consistency.hpp"
#include "analysis/metrics/credibility.hpp"
#include "analysis/metrics/error_anatomy.hpp"
#include "analysis/metrics/innovations.hpp"
#include "analysis/metrics/lineages.hpp"
#include "analysis/metrics/reference_analysis.hpp"
#include "analysis/metrics/run_scores.hpp"
#include "analysis/mismatch/mismatch.hpp"
#include "analysis/statistics/summary.hpp"
#include "analysis/statistics/survival.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace montecarta {

/// A NEES series and what it says.
struct NeesResult {
  ErrorBlock block = ErrorBlock::pose;
  Moments moments = Moments::spread;
  NeesSeries series;
  Consistency consistency;
};

/// Errors of the estimate over complete runs. Per run: over its scans. Over time: over runs.
struct ErrorSummary {
  Summary position_rmse;                   ///< [m]
  Summary position_mse;                    ///< [m^2]
  Summary position_mean;                   ///< [m] distance
  Summary position_variance;               ///< [m^2] of the distance over time
  Summary heading_rmse;                    ///< [rad]
  Summary heading_mse;                     ///< [rad^2]
  Summary heading_mean;                    ///< [rad] absolute
  std::vector<double> position_over_time;  ///< [m] {scan} RMSE over runs
  std::vector<double> heading_over_time;   ///< [rad] {scan} RMSE over runs
};

/// Effective number of particles and how often they are resampled.
struct WeightSummary {
  Summary ess;                        ///< mean over the scans of a run
  Summary resampling_rate;            ///< share of scans that end with a resampling
  std::vector<double> ess_over_time;  ///< {scan} mean over runs
};

/// Distinct ancestors of the particles of a scan (SPEC 18).
struct DiversitySummary {
  Summary last_resampling;  ///< parents in the last resampling, mean over the scans of a run
  Summary lag;              ///< ancestors kDiversityLag ago, mean over the scans of a run
  Summary root;             ///< ancestors at the start, mean over the scans of a run
  Summary final_root;       ///< ancestors at the start of the particles of the last scan
  std::vector<double> last_resampling_over_time;  ///< {scan} mean over runs, as the next two
  std::vector<double> lag_over_time;
  std::vector<double> root_over_time;
};

/// Ancestries over runs (Lineages).
struct LineageSummary {
  std::array<double, kLineageLags.size()> ancestors{};  ///< {lag} mean over runs; NaN: too short
  double coalescence = 0.0;        ///< [s] mean over the runs that have a common ancestor
  double coalesced_share = 0.0;    ///< of the scans looked at
  double monte_carlo_share = 0.0;  ///< of the mean squared position error that is due to few
                                   ///< particles; NaN where particles are not stored
};

/// What became of detections in a run, in sums over its scans (AssociationCounts).
struct AssociationSummary {
  Summary correct, wrong, new_again, missed, clutter;
};

/// A run that ended early: a result like any other.
struct FailedRun {
  std::uint64_t run = 0;
  std::uint32_t step = 0;  ///< 0-based
  std::string reason;
};

/// All metrics of a cell. Errors, NEES, weights and diversity are over complete runs only.
struct CellAnalysis {
  std::string label;
  std::string filter;
  std::string long_name;
  std::size_t particles = 0;  ///< 0: not a particle filter
  Mismatch mismatch;          ///< what it believes besides what the study tells
  std::size_t complete = 0;
  std::size_t missing = 0;
  std::size_t spared = 0;  ///< not made: the cell was precise enough
  std::vector<FailedRun> failures;
  Moments leading = Moments::spread;  ///< of errors and verdict: the first of kMoments there is
  std::vector<NeesResult> nees;       ///< leading first; pose, position, heading; may be empty
  ErrorSummary error;                 ///< of the leading mean
  std::optional<WeightSummary> weights;
  std::optional<DiversitySummary> diversity;
  std::optional<LineageSummary> lineages;
  std::optional<Survival> survival;        ///< where there is a leading covariance and a truth
  std::optional<Credibility> credibility;  ///< likewise
  std::optional<ErrorAnatomy> anatomy;     ///< likewise
  std::optional<Innovations> innovations;  ///< where a filter has any
  std::optional<AssociationSummary> association;
  std::vector<PitHistogram> calibration;      ///< where the noise is matched; else empty
  MapErrors map;                              ///< of the final maps
  JointConsistency joint;                     ///< of pose and map together
  Efficiency efficiency;                      ///< against StudyAnalysis::bound
  std::vector<ReferenceAnalysis> references;  ///< one for each of the drive's, the leading first
  std::vector<double> map_size_over_time;  ///< [1] {scan} mean over runs; of a drive without truth
  std::vector<std::uint64_t> runs;         ///< numbers of the complete runs, increasing
  std::vector<RunScores> scores;           ///< of each of them
  std::vector<double> run_exits;  ///< [s] of each: its own lasting exit (Survival); infinity: never
  RunScores lower, upper;         ///< where the mean of each score over infinitely many runs lies
  Summary cpu_seconds;            ///< [s] of each complete run's own thread over its steps
  Summary numerical_faults;       ///< factorisations answered by a fallback, per run

  /// nullptr where it is not stored.
  const NeesResult* find_nees(ErrorBlock block, Moments moments) const;
  /// A score over the complete runs that have it: a map without beacons has no beacon error.
  Spread known_over_runs(double RunScores::*score) const;
  /// The verdict on the pose by the leading moments; untested where there is none.
  Consistency consistency() const;
};

}  // namespace montecarta
