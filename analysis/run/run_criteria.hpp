// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/map_scores.hpp"
#include "analysis/run/path_at_fixes.hpp"
#include "analysis/run/run_metrics.hpp"
#include "analysis/statistics/error_spending.hpp"
#include "engine/core/judgement.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// Criteria for a run on a drive of its own.
struct DriveCriteria {
  std::span<const double> times;  ///< [s] {scan} time of each scan
  /// {scan} row of each scan; empty if rows are scans.
  std::span<const std::uint32_t> scan_rows;
  std::vector<PathAtFixes> references;  ///< {reference} its fixes on the path of this drive
};

/// Criteria for runs, common to all cells of a file. The file must outlive them.
struct RunCriteria {
  std::span<const double> times;           ///< [s] {judged scan} time of each scan
  double level = kUsualLevel;              ///< level of NEES bounds and tests
  double within = kUsualMargin;            ///< margin of the verdict (judge())
  std::vector<PathAtFixes> references;     ///< {reference} its fixes on the path of the rows
  std::vector<Eigen::Vector2d> beacons;    ///< [m] positions of surveyed beacons
  MapCriteria map;                         ///< criteria for the maps of a simulation
  std::vector<std::uint32_t> joint_scans;  ///< judged scans at which joint estimates are stored
  /// {scan} row of each scan; empty if rows are scans.
  std::span<const std::uint32_t> scan_rows = {};
  ErrorFrame frame = ErrorFrame::of_truth;
  /// Number of tests of an estimator that are judged together: of innovations alone, their
  /// whiteness and their size at each sensor; else 1.
  std::size_t tests_together = 1;
  /// Number of components if the judged errors are innovations, whose whiteness is tested; else 0.
  std::size_t innovation_components = 0;
  bool has_own_scans = false;  ///< whether a cell has no estimate at scans of other cells
  bool calibrates = false;     ///< whether the PITs of errors are judged: only with matched noise
  /// {interim analysis} number of runs, if cells stop when their verdict is known; else empty.
  std::vector<std::uint64_t> runs_at_analyses = {};
  /// Share of the study's runs that the file has: less than 1 in a shard.
  double share_of_runs = 1.0;
  /// {component} names of the components of the judged errors.
  std::vector<std::string> components = {};
  std::vector<std::string> units = {};  ///< {component} of imported errors, else empty
  /// Whether all runs process one recorded drive, and so have the same measurements.
  bool has_same_measurements = false;
  /// {run of the study} criteria for each drive; empty if all runs process one drive. Otherwise
  /// `times` are those of the drive with the most scans, and `references` those of the first. Such
  /// drives are recordings without truth: they have no errors and no NEES.
  std::vector<DriveCriteria> drives = {};

  /// Level of one of tests_together tests, such that all of them have `level` (Bonferroni).
  double level_of_each() const { return 1.0 - (1.0 - level) / static_cast<double>(tests_together); }
  /// Level of a verdict on this number of runs, such that all interim analyses and all
  /// tests_together have `level`.
  double verdict_level(std::uint64_t runs) const {
    return level_of_analysis(level_of_each(), runs_at_analyses, runs);
  }
};

}  // namespace montecarta::analysis
