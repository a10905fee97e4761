// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/run_rows.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>

namespace montecarta::analysis {

/// Number of parts of a run; calibration is tested at the end of each.
inline constexpr std::size_t kQuarters = 4;

/// {quarter} The last scan of each quarter of a run of `scans` >= 1.
inline std::array<std::size_t, kQuarters> calibration_scans(std::size_t scans) {
  std::array<std::size_t, kQuarters> chosen{};
  for (std::size_t m = 0; m < kQuarters; ++m) {
    const std::size_t until = (m + 1) * scans / kQuarters;
    chosen[m] = until == 0 ? 0 : until - 1;
  }
  return chosen;
}

/// Probability integral transforms (PIT) of one run, uniform over runs if the filter is calibrated.
/// A transform that is not defined is NaN.
struct RunPits {
  using Components = std::array<double, 3>;  ///< x, y, heading in the map frame
  /// {quarter} transforms of the pose by the Gaussian of the leading moments. At a scan that drew
  /// poses, the law is Student's t with as many effective draws about their mean.
  std::array<Components, kQuarters> pose{};
  /// {quarter} transforms by the weighted particles, at scans that drew poses.
  std::array<Components, kQuarters> rank{};
  /// {quarter} rank of the squared distance of the truth among those of half of the particles.
  std::array<double, kQuarters> rank_nees{};
  std::array<double, 2> landmark{};  ///< x, y of one landmark of the final map
  /// {quarter} transforms of the leading NEES by its chi-square law.
  std::array<double, kQuarters> nees{};
  /// Whether the data behind each transform are stored.
  bool has_pose = false, has_rank = false, has_landmark = false, has_nees = false;
  static constexpr auto members() {
    using Pits = RunPits;
    return std::tuple(&Pits::pose, &Pits::rank, &Pits::rank_nees, &Pits::landmark, &Pits::nees,
                      &Pits::has_pose, &Pits::has_rank, &Pits::has_landmark, &Pits::has_nees);
  }
};

/// The transforms of errors in run number `run` with `particles` (0: not a particle filter).
/// `landmarks` [m] are the true positions by identity, empty if unknown. Every run gives one
/// landmark, a different one from run to run, because the errors of one map are correlated.
RunPits pits_of(const RunRows& rows, std::size_t particles, std::uint64_t run,
                std::span<const Eigen::Vector2d> landmarks);

/// Transforms of `nees` {scan} by the chi-square law of `dimension` degrees of freedom, at
/// calibration_scans(). The transform of a value that is not finite is NaN.
std::array<double, kQuarters> nees_pits(std::span<const double> nees, std::size_t dimension);

}  // namespace montecarta::analysis
