// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/run_rows.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// Normalised estimation error squared of pose and map together, of one run at one scan.
struct JointScore {
  /// NEES, e' P^-1 e; NaN if error or covariance is not finite, or P is not positive definite.
  double nees = 0.0;
  std::size_t dimension = 0;  ///< number of components: 3 + 2 x landmarks in the map
};

/// Scores each row of `rows`, which are stored at these `scans`. `truth` {scan, 3} [m, m, rad] is
/// the true path, and `landmarks` [m] are the true positions by identity.
std::vector<JointScore> joint_scores(const JointRows& rows, std::span<const std::uint32_t> scans,
                                     std::span<const double> truth,
                                     std::span<const Eigen::Vector2d> landmarks);

/// Sum of the defined NEES divided by the sum of their dimensions; NaN if none is defined.
double nees_per_component(std::span<const JointScore> scores);

}  // namespace montecarta::analysis
