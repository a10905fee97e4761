// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/cell_calibration.hpp"
#include "analysis/metrics/consistency.hpp"
#include "analysis/metrics/credibility.hpp"
#include "analysis/metrics/efficiency.hpp"
#include "analysis/metrics/error_anatomy.hpp"
#include "analysis/metrics/innovations.hpp"
#include "analysis/metrics/joint_nees.hpp"
#include "analysis/metrics/lineage_sums.hpp"
#include "analysis/metrics/map_errors.hpp"
#include "analysis/metrics/mismatch.hpp"
#include "analysis/metrics/moments.hpp"
#include "analysis/metrics/reference_analysis.hpp"
#include "analysis/metrics/score.hpp"
#include "analysis/statistics/summary.hpp"
#include "analysis/statistics/survival.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace montecarta {

/// A NEES series and what it says.
struct NeesResult {
  ErrorBlock block = ErrorBlock::pose;
  Moments moments = Moments::spread;
  NeesSeries series;
  Consistency consistency;
};

/// A number of every scan over runs, under the name it has in files.
struct NamedSeries {
  std::string name;   ///< e.g. "anees_pose_mixture"
  std::string units;  ///< UDUNITS style, "1" where there is none
  std::vector<double> values;
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
  std::optional<LineageSummary> lineages;
  std::optional<Survival> survival;           ///< where there is a leading covariance and a truth
  std::optional<Credibility> credibility;     ///< likewise
  std::optional<ErrorAnatomy> anatomy;        ///< likewise
  std::optional<Innovations> innovations;     ///< where a filter has any
  std::vector<PitHistogram> calibration;      ///< where the noise is matched; else empty
  MapErrors map;                              ///< of the final maps
  JointConsistency joint;                     ///< of pose and map together
  Efficiency efficiency;                      ///< against StudyAnalysis::bound
  std::vector<ReferenceAnalysis> references;  ///< one for each of the drive's, the leading first
  std::vector<std::uint64_t> runs;            ///< numbers of the complete runs, increasing
  ScoreTable scores;                          ///< of each of them
  std::vector<Interval> score_intervals;      ///< {score} of the mean over infinitely many runs
  std::vector<NamedSeries> scan_series;       ///< of all_scan_series() those that apply
  std::vector<double> run_exits;  ///< [s] of each: its own lasting exit (Survival); infinity: never

  /// nullptr where it is not stored.
  const NeesResult* find_nees(ErrorBlock block, Moments moments) const;
  /// Of a score over the complete runs; NaN where one of them has none.
  Summary over_runs(std::string_view score) const;
  /// Of a score over the complete runs that have it: a map without beacons has no beacon error.
  Spread known_over_runs(const Score& score) const;
  Spread known_over_runs(std::string_view score) const;
  /// Where the mean of a score over infinitely many runs lies.
  Interval interval_of(std::string_view score) const;
  /// {scan} of this name; empty where it does not apply.
  const std::vector<double>& over_time(std::string_view series) const;
  /// The verdict on the pose by the leading moments; untested where there is none.
  Consistency consistency() const;
};

}  // namespace montecarta
