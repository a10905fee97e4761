// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/calibration/cell_calibration.hpp"
#include "analysis/joint/joint_nees.hpp"
#include "analysis/map/map_errors.hpp"
#include "analysis/metrics/beacon_scores.hpp"
#include "analysis/metrics/cell_accumulator.hpp"
#include "analysis/metrics/path_at_fixes.hpp"
#include "analysis/metrics/reference_analysis.hpp"
#include "analysis/run_reader.hpp"
#include "engine/runs/parallel.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace montecarta {

/// What runs are measured by, common to all cells of a file, which must outlive it.
struct Yardsticks {
  std::span<const double> times;  ///< [s] of the scans
  double level = 0.95;            ///< of NEES bounds
  std::vector<PathAtFixes> references;
  std::vector<Eigen::Vector2d> beacons;        ///< [m]
  MapYardstick map;                            ///< of a simulation
  std::span<const std::uint32_t> joint_scans;  ///< of joint estimates
  BandWalks walks;                             ///< of as many scans where there is a truth
  bool calibrates = false;  ///< whether calibration is judged: where noise is matched
};

Yardsticks yardsticks_of(const ResultFile& file, double level);

/// One run being read and measured while others are. Keeps its memory from run to run.
struct MeasuredRun {
  RunRows rows;
  RunReader::Scratch scratch;
  RunMetrics metrics;
  std::vector<ReferenceRun> references;
  std::optional<BeaconScores> beacons;  ///< where the final map is stored and beacons are known
  std::optional<MapScores> map;         ///< where it is stored and the world is known
  std::vector<JointScore> joint;        ///< where joint estimates are stored
  RunPits pits;                         ///< where calibration is judged

  /// Of `rows` of a complete run.
  void measure(const Yardsticks& sticks, std::size_t particles);
};

/// Adds up complete runs of one cell in the order of the calls.
class CellSums {
 public:
  explicit CellSums(const Yardsticks& sticks)
      : sums_(sticks.times, sticks.level, sticks.walks),
        references_(sticks.references.size()),
        level_(sticks.level),
        knows_landmarks_(sticks.map.known),
        knows_identities_(sticks.map.identities_known),
        times_(sticks.times),
        calibrates_(sticks.calibrates) {}

  void add(const MeasuredRun& run);
  /// {run} All single numbers of every run.
  std::vector<RunScores> scores() const;
  /// Fills all that complete runs say; label, failures and missing runs are the caller's.
  CellAnalysis result();

 private:
  CellAccumulator sums_;
  std::vector<ReferenceAccumulator> references_;
  std::vector<std::optional<BeaconScores>> beacons_;  ///< {run}
  MapErrorSums map_;
  JointNeesSums joint_;
  double level_;
  bool knows_landmarks_;
  bool knows_identities_;
  std::span<const double> times_;
  CalibrationSums calibration_;
  bool calibrates_;
};

/// As many as are worth measuring at once.
std::vector<MeasuredRun> slots_for(const Parallel& parallel);

/// Measures runs at once, a slot each, and adds them up in order, whoever was first.
void add_runs(const RunReader& reader, std::span<const std::size_t> runs, std::size_t particles,
              const Yardsticks& sticks, const Parallel& parallel, std::vector<MeasuredRun>& slots,
              CellSums& sums);

}  // namespace montecarta
