// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/map_scores.hpp"
#include "analysis/run/path_at_fixes.hpp"
#include "analysis/run/run_metrics.hpp"
#include "engine/core/judgement.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// Criteria for a run on a drive of its own.
struct DriveCriteria {
  std::span<const double> times;          ///< [s] of the scans
  std::vector<PathAtFixes> references;    ///< as many as those of RunCriteria
  std::vector<PathAtFixes> judged_fixes;  ///< likewise
};

/// Criteria for runs, common to all cells of a file, which must outlive them.
struct RunCriteria {
  std::span<const double> times;  ///< [s] of the scans
  double level = kUsualLevel;     ///< of NEES bounds
  double within = kUsualMargin;   ///< margin of the verdict (judge())
  std::vector<PathAtFixes> references;
  std::vector<Eigen::Vector2d> beacons;        ///< [m]
  MapCriteria map;                             ///< of a simulation
  std::span<const std::uint32_t> joint_scans;  ///< of joint estimates
  std::vector<PathAtFixes> judged_fixes = {};  ///< of the scans, of references with known errors
  ErrorFrame frame = ErrorFrame::of_truth;
  bool calibrates = false;  ///< whether the PITs of errors are judged: only with matched noise
  /// Runs at each interim analysis, if cells stop when their verdict is known.
  std::vector<std::uint64_t> looks = {};
  double share_of_runs = 1.0;  ///< of the study's that the file has: less than 1 in a shard
  /// Components of the errors that are judged.
  std::vector<std::string> components = {};
  /// {run of the study} Empty if all runs process one drive. Otherwise `times` are those of the
  /// longest drive, and references and judged_fixes those of the first. Such drives are recordings
  /// without truth: they have no errors and no NEES.
  std::vector<DriveCriteria> drives = {};

  /// Level of a verdict on so many runs, so that all interim analyses together have `level`.
  double verdict_level(std::uint64_t runs) const;
};

}  // namespace montecarta::analysis
