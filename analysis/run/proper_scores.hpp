// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/nees.hpp"
#include "analysis/run/run_rows.hpp"
#include "analysis/statistics/spread.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <span>

namespace montecarta::analysis {

/// Proper scores of one run (STATISTICS 7): the smaller, the better the filter's distribution
/// agrees with the truth. Their mean is least for the distribution from which the truth is drawn,
/// so a covariance that is too small is penalised, and so is one that is too large.
struct ProperScores {
  /// Negative logarithm of the density of the pose [m, m, rad], mean over scans; NaN without a
  /// covariance.
  double log_score = kNaN;
  /// [m] energy score of the position, mean over at most kMostEnergyScans scans; NaN if particles
  /// are not stored.
  double energy_score = kNaN;
};

inline constexpr std::size_t kMostEnergyScans = 20;

/// Mean of -log N(e; 0, P) over scans. Scans with a singular or unusable covariance are left out.
double log_score(std::span<const WhitenedPose> errors);

/// E|X - y| - E|X - X'| / 2 [m] of weighted positions X; `pose` {particle, 3} [m, m, rad],
/// `log_weight` {particle} normalised, `truth` [m].
double energy_score(std::span<const double> pose, std::span<const double> log_weight,
                    const Eigen::Vector2d& truth);

/// Computes both scores of a run. `errors` {scan} are those of RunMetrics; `particles` is the
/// number of particles.
ProperScores proper_scores(const RunRows& rows, std::size_t particles,
                           std::span<const WhitenedPose> errors);

}  // namespace montecarta::analysis
