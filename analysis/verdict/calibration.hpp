// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/pits.hpp"
#include "analysis/statistics/sums.hpp"
#include "analysis/statistics/uniformity.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace montecarta::analysis {

/// Name of the quantity that is transformed by the law of the NEES.
inline constexpr const char* kNees = "NEES";

/// The transforms of one quantity over runs, compared to the uniform law.
struct JudgedPits {
  std::string quantity;       ///< "x", "y", "heading", "landmark x", "landmark y", "NEES"
  std::string by;             ///< law of the transform: "Gaussian" or "particles"
  double time = 0.0;          ///< [s] time of the scan
  std::size_t undefined = 0;  ///< number of runs without a value
  Uniformity test;

  bool is_like(const JudgedPits& other) const {
    return quantity == other.quantity && by == other.by && time == other.time;
  }
};

/// The judged transforms of a cell; empty if none is judged.
using Calibrations = std::vector<JudgedPits>;

/// Collects the transforms of complete runs in the order of the calls.
class CalibrationSums {
 public:
  void add(const RunPits& run) { runs_.push_back(run); }
  /// Tests all quantities at the ends of the quarters; `times` [s] are those of all scans. With a
  /// probability of at least `level`, no test finds a fault in a calibrated cell. The order is pose
  /// by moments, ranks, landmarks, NEES, its ranks; quantities that are not stored are absent.
  Calibrations result(std::span<const double> times, double level) const;
  static constexpr auto parts() { return std::tuple(appended(&CalibrationSums::runs_)); }

 private:
  std::vector<RunPits> runs_;
};

}  // namespace montecarta::analysis
