// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/drive.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "analysis/metrics/verdict_table.hpp"
#include "analysis/output/figure.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/statistics/sums.hpp"

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// A rotation of the plane followed by a translation.
struct RigidMotion {
  double angle = 0.0;                               ///< [rad] counter-clockwise
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();  ///< [m]

  Eigen::Vector2d operator()(const Eigen::Vector2d& point) const;
};

/// The rigid motion that minimises the sum of squared distances between pairs of the points `from`
/// [m] and `onto` [m], in closed form (Umeyama 1991 without scale). One point is only shifted;
/// without points it is the identity.
RigidMotion rigid_alignment(std::span<const Eigen::Vector2d> from,
                            std::span<const Eigen::Vector2d> onto);

/// Gated numbers use the fixes with an error of at most so many times the run's own median error,
/// since a GPS fix may be 136 m off. Read them with the share of fixes kept: a filter that leaves
/// the path half way keeps few.
inline constexpr double kReferenceGate = 4.0;
/// A run has lost the map if the median of its aligned errors is larger than this [m].
inline constexpr double kLostBeyond = 10.0;

/// Distances between the estimate of one run and the fixes of a reference (STATISTICS 16), raw or
/// aligned. Aligned distances are taken after the rigid motion that brings the estimate nearest to
/// all fixes, which removes the unknown error of the start's position and heading. NaN without
/// fixes.
struct ReferenceScores {
  double rms = kNaN;                  ///< [m] raw
  double median = kNaN;               ///< [m] raw
  double gated_rms = kNaN;            ///< [m] raw, over fixes within kReferenceGate medians
  double gated_share = kNaN;          ///< [1] of fixes within
  double aligned_rms = kNaN;          ///< [m]
  double aligned_median = kNaN;       ///< [m]
  double aligned_gated_rms = kNaN;    ///< [m]
  double aligned_gated_share = kNaN;  ///< [1]
  double heading_rmse = kNaN;         ///< [rad] raw; NaN where the reference has no heading

  static constexpr auto members() {
    using Scores = ReferenceScores;
    return std::tuple(&Scores::rms, &Scores::median, &Scores::gated_rms, &Scores::gated_share,
                      &Scores::aligned_rms, &Scores::aligned_median, &Scores::aligned_gated_rms,
                      &Scores::aligned_gated_share, &Scores::heading_rmse);
  }

  /// True even if estimates are not finite: gated_share is then 0.
  bool has_fixes() const { return !std::isnan(rms) || !std::isnan(gated_share); }
  bool lost() const { return !(aligned_median <= kLostBeyond); }
};

/// One run against one reference.
struct ReferenceRun {
  ReferenceScores scores;
  std::vector<double> squared_error;  ///< [m^2] {fix} raw
  RigidMotion alignment;              ///< of the path onto the fixes
};

/// Compares a path {row, 3} [m, m, rad] with `fixes`, which were made for its rows.
ReferenceRun measure_against(const PathAtFixes& fixes, std::span<const double> path);

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

/// One row for each cell and reference: distances to the fixes, and runs that lost the map.
TextTable reference_table(const StudyAnalysis& study);

/// One row for each cell: its final map, beacons found, effective particles and cost of a run.
TextTable map_table(const StudyAnalysis& study);

/// One row for each cell: runs that lost the map, and runs that were nearer to the leading
/// reference than EKF-SLAM is on average. No rows if there is no reference.
TextTable baseline_table(const StudyAnalysis& study);

/// Why a recorded drive has no verdict on consistency.
std::string no_truth_sentence(const StudyAnalysis& study);

/// Notes on the tables.
std::vector<std::string> reference_notes(const StudyAnalysis& study);

/// The baseline: the first cell of the filter ekf_slam with complete runs; nullptr if there is
/// none.
const CellAnalysis* baseline_of(const StudyAnalysis& study);

/// Numbers of a cell for one reference, named as in files: each over runs as mean, standard error,
/// median, least and greatest; and the numbers of its maps.
Frame::Row reference_numbers(const CellAnalysis& cell, std::size_t reference);

/// RMS over runs of the raw distance to the leading reference at each fix, one curve for each cell;
/// logarithmic if it spans more than two decades.
Figure reference_error_figure(const StudyAnalysis& study);
/// Landmarks in the map over time, one curve for each cell.
Figure map_size_figure(const StudyAnalysis& study);

}  // namespace montecarta::analysis
