// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/data/run_rows.hpp"
#include "analysis/statistics/uniformity.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// Probability integral transforms of one run: which share of what a filter holds for possible lies
/// below the truth. Uniform over runs if the filter is calibrated. NaN where not defined.
struct RunPits {
  using Components = std::array<double, 3>;  ///< x, y, heading in the map frame
  /// By the Gaussian of the leading moments; of poses that the scan drew by Student's t of as many
  /// effective draws about their mean.
  std::array<Components, kQuarters> pose{};
  std::array<Components, kQuarters> rank{};  ///< by the weighted particles
  std::array<double, 2> landmark{};          ///< x, y of one landmark of the final map
  bool has_pose = false, has_rank = false, has_landmark = false;  ///< what is stored
};

/// Of run number `run` with `particles` (0: none). `landmarks` [m]: where they really are, by
/// identity; empty where unknown. Every run gives one landmark alone, another one from run to run:
/// those of one map are correlated.
RunPits pits_of(const RunRows& rows, std::size_t particles, std::uint64_t run,
                std::span<const Eigen::Vector2d> landmarks);

/// One histogram over runs.
struct PitHistogram {
  std::string quantity;       ///< "x", "y", "heading", "landmark x", "landmark y"
  std::string by;             ///< "Gaussian" or "particles"
  double time = 0.0;          ///< [s] of the scan
  std::size_t undefined = 0;  ///< runs without a value: no positive variance, or an empty map
  Uniformity test;
};

/// Of a cell; empty where nothing is judged.
using Calibrations = std::vector<PitHistogram>;

/// Collects the transforms of complete runs in the order of the calls.
class CalibrationSums {
 public:
  void add(const RunPits& run) { runs_.push_back(run); }
  /// `times` [s] of all scans. A cell that is calibrated has no fault in any histogram with
  /// probability `level` at least. Pose by moments, then ranks, then landmarks; what is not stored
  /// is absent.
  Calibrations result(std::span<const double> times, double level) const;

 private:
  std::vector<RunPits> runs_;
};

}  // namespace montecarta::analysis
