// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/pit.hpp"
#include "analysis/statistics/uniformity.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

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
