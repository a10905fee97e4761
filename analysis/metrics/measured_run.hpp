// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/data/run_reader.hpp"
#include "analysis/metrics/consistency.hpp"
#include "analysis/metrics/drive_scores.hpp"
#include "analysis/metrics/joint_nees.hpp"
#include "analysis/metrics/map_scores.hpp"
#include "analysis/metrics/path_at_fixes.hpp"
#include "analysis/metrics/pit.hpp"
#include "analysis/metrics/reference_scores.hpp"
#include "analysis/metrics/run_metrics.hpp"
#include "analysis/statistics/whole_run_band.hpp"
#include "engine/records/result_file.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// What a run is measured by whose drive is its own.
struct DriveCriteria {
  std::span<const double> times;          ///< [s] of the scans
  std::vector<PathAtFixes> references;    ///< as many as those of RunCriteria
  std::vector<PathAtFixes> judged_fixes;  ///< likewise
};

/// What runs are measured by, common to all cells of a file, which must outlive it.
struct RunCriteria {
  std::span<const double> times;  ///< [s] of the scans
  double level = 0.95;            ///< of NEES bounds
  double within = kUsualMargin;   ///< what counts as consistent (judge())
  std::vector<PathAtFixes> references;
  std::vector<Eigen::Vector2d> beacons;        ///< [m]
  MapCriteria map;                             ///< of a simulation
  std::span<const std::uint32_t> joint_scans;  ///< of joint estimates
  BandWalks walks;                             ///< of as many scans where there is a truth
  std::vector<PathAtFixes> judged_fixes = {};  ///< of the scans, of references with known errors
  bool calibrates = false;  ///< whether calibration is judged: where noise is matched
  /// Of each verdict where cells stop by verdict, so that all looks together have `level`.
  std::optional<double> look_level = {};
  /// {run of the study} Where every run is a drive of its own; then times are those of the longest
  /// one, references and judged_fixes those of the first.
  std::vector<DriveCriteria> drives = {};

  double verdict_level() const { return look_level.value_or(level); }
};

RunCriteria criteria_of(const ResultFile& file, double level, double within = kUsualMargin);

/// One run being read and measured while others are. Keeps its memory from run to run.
struct MeasuredRun {
  RunRows rows;
  RunReader::Scratch scratch;
  RunMetrics metrics;
  std::vector<ReferenceRun> references;
  std::vector<DriveScores> drives;      ///< by each of RunCriteria::judged_fixes
  std::optional<BeaconScores> beacons;  ///< where the final map is stored and beacons are known
  std::optional<MapScores> map;         ///< where it is stored and the world is known
  std::vector<JointScore> joint;        ///< where joint estimates are stored
  bool has_identities = false;          ///< whether anybody knows which landmark is which
  RunPits pits;                         ///< where calibration is judged

  /// Of `rows` of a complete run.
  void measure(const RunCriteria& criteria, std::size_t particles);
};

}  // namespace montecarta::analysis
