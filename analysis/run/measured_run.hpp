// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/drive_scores.hpp"
#include "analysis/run/joint_scores.hpp"
#include "analysis/run/map_scores.hpp"
#include "analysis/run/pits.hpp"
#include "analysis/run/proper_scores.hpp"
#include "analysis/run/reference_scores.hpp"
#include "analysis/run/run_criteria.hpp"
#include "analysis/run/run_metrics.hpp"
#include "analysis/run/run_rows.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// One run being read and measured while others are. Keeps its memory from run to run.
struct MeasuredRun {
  RunRows rows;
  std::span<const double> times;  ///< [s] of its scans
  RunMetrics metrics;
  std::vector<ReferenceRun> references;
  std::vector<DriveScores> drives;      ///< by each of RunCriteria::judged_fixes
  std::optional<BeaconScores> beacons;  ///< where the final map is stored and beacons are known
  std::optional<MapScores> map;         ///< where it is stored and the world is known
  std::vector<JointScore> joint;        ///< where joint estimates are stored
  bool has_identities = false;          ///< whether anybody knows which landmark is which
  RunPits pits;                         ///< of errors and NEES
  ProperScores proper;                  ///< of a known truth

  /// Measures `rows` of a complete run.
  void measure(const RunCriteria& criteria, std::size_t particles);
};

}  // namespace montecarta::analysis
