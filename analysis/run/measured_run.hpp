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

/// One run that is read and measured. The object keeps its memory from run to run; each thread has
/// its own.
struct MeasuredRun {
  RunRows rows;
  std::span<const double> times;  ///< [s] {scan} time of each scan
  RunMetrics metrics;
  std::vector<ReferenceRun> references;
  /// {reference with known errors} scores at its fixes.
  std::vector<DriveScores> drives;
  /// Present if the final map is stored and beacons are known.
  std::optional<BeaconScores> beacons;
  std::optional<MapScores> map;   ///< present if the final map is stored and the world is known
  std::vector<JointScore> joint;  ///< {joint scan} scores; empty if no joint estimates are stored
  bool has_identities = false;    ///< whether it is known which landmark is which
  RunPits pits;                   ///< transforms of errors and NEES
  ProperScores proper;            ///< NaN without a known truth

  /// Measures `rows` of a complete run.
  void measure(const RunCriteria& criteria, std::size_t particles);
};

}  // namespace montecarta::analysis
