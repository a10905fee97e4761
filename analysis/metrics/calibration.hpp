// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/data/run_rows.hpp"
#include "analysis/statistics/sums.hpp"
#include "analysis/statistics/uniformity.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// Number of parts of a run at the ends of which calibration is tested.
inline constexpr std::size_t kQuarters = 4;

/// The scan that ends each quarter of a run of `scans` >= 1.
inline std::array<std::size_t, kQuarters> calibration_scans(std::size_t scans) {
  std::array<std::size_t, kQuarters> chosen{};
  for (std::size_t m = 0; m < kQuarters; ++m) {
    const std::size_t until = (m + 1) * scans / kQuarters;
    chosen[m] = until == 0 ? 0 : until - 1;
  }
  return chosen;
}

/// Probability integral transforms (PIT) of one run, uniform over runs if the filter is calibrated.
/// NaN where not defined.
struct RunPits {
  using Components = std::array<double, 3>;  ///< x, y, heading in the map frame
  /// By the Gaussian of the leading moments. Where a scan drew poses, it is Student's t with as
  /// many effective draws about their mean.
  std::array<Components, kQuarters> pose{};
  std::array<Components, kQuarters> rank{};  ///< by the weighted particles
  std::array<double, 2> landmark{};          ///< x, y of one landmark of the final map
  std::array<double, kQuarters> nees{};      ///< of the leading NEES, by its chi-square law
  /// Which of them are stored.
  bool has_pose = false, has_rank = false, has_landmark = false, has_nees = false;
  static constexpr auto members() {
    using Pits = RunPits;
    return std::tuple(&Pits::pose, &Pits::rank, &Pits::landmark, &Pits::nees, &Pits::has_pose,
                      &Pits::has_rank, &Pits::has_landmark, &Pits::has_nees);
  }
};

/// The transforms of errors in run number `run` with `particles` (0: none). `landmarks` [m] are the
/// true positions by identity, empty if unknown. Every run gives one landmark, another one from run
/// to run, because those of one map are correlated.
RunPits pits_of(const RunRows& rows, std::size_t particles, std::uint64_t run,
                std::span<const Eigen::Vector2d> landmarks);

/// Transforms of `nees` {scan} by the chi-square law of `dimension` degrees of freedom, at
/// calibration_scans(). NaN of a value that is not finite.
std::array<double, kQuarters> nees_pits(std::span<const double> nees, std::size_t dimension);

/// The transforms of one quantity over runs, compared to the uniform law.
struct JudgedPits {
  std::string quantity;       ///< "x", "y", "heading", "landmark x", "landmark y", "NEES"
  std::string by;             ///< "Gaussian" or "particles"
  double time = 0.0;          ///< [s] of the scan
  std::size_t undefined = 0;  ///< runs without a value
  Uniformity test;

  bool is_like(const JudgedPits& other) const {
    return quantity == other.quantity && by == other.by && time == other.time;
  }
};

/// The judged transforms of a cell; empty if nothing is judged.
using Calibrations = std::vector<JudgedPits>;

/// Collects the transforms of complete runs in the order of the calls.
class CalibrationSums {
 public:
  void add(const RunPits& run) { runs_.push_back(run); }
  /// `times` [s] of all scans. A calibrated cell has no fault in any test with probability `level`
  /// at least. The order is pose by moments, ranks, landmarks, NEES; quantities that are not stored
  /// are absent.
  Calibrations result(std::span<const double> times, double level) const;
  static constexpr auto parts() { return std::tuple(appended(&CalibrationSums::runs_)); }

 private:
  std::vector<RunPits> runs_;
};

}  // namespace montecarta::analysis
