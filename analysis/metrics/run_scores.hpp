// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/run_metrics.hpp"
#include "analysis/metrics/run_rows.hpp"

#include <cstddef>
#include <limits>
#include <span>

namespace montecarta {

/// Every run in single numbers: what is averaged over runs, and compared run by run. NaN where one
/// does not apply.
struct RunScores {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  double position_rmse = kNone;      ///< [m]
  double position_mse = kNone;       ///< [m^2]
  double position_mean = kNone;      ///< [m] distance, mean over scans
  double position_variance = kNone;  ///< [m^2] of the distance over scans
  double heading_rmse = kNone;       ///< [rad]
  double heading_mse = kNone;        ///< [rad^2]
  double heading_mean = kNone;       ///< [rad] absolute
  double nees = kNone;               ///< [1] of the pose, mean over scans, leading moments
  double nees_position = kNone;      ///< [1] of the position
  double nees_distance = kNone;      ///< [1] doublings between `nees` and its number of components
  double ess = kNone;                ///< [1] mean over scans
  double resampling_rate = kNone;    ///< [1] share of scans
  double last_resampling = kNone;    ///< [1] distinct parents in the last resampling, over scans
  double lag = kNone;                ///< [1] distinct ancestors kDiversityLag ago, over scans
  double root = kNone;               ///< [1] distinct ancestors at the start, over scans
  double final_root = kNone;         ///< [1] the same at the last scan
  double coalescence = kNone;        ///< [s] back to the common ancestor (Lineages)
  double monte_carlo_variance = kNone;  ///< [m^2] of the position, by few particles (Lineages)
  double correct = kNone;  ///< [1] sum over scans, as the next four (AssociationCounts)
  double wrong = kNone;
  double new_again = kNone;
  double missed = kNone;
  double clutter = kNone;
  double reference_rms = kNone;  ///< [m] of the leading reference, as the next six
                                 ///< (ReferenceScores)
  double reference_median = kNone;
  double reference_gated_rms = kNone;
  double reference_aligned_rms = kNone;
  double reference_aligned_median = kNone;
  double reference_aligned_gated_rms = kNone;
  double reference_heading_rmse = kNone;  ///< [rad]
  double map_landmarks = kNone;           ///< [1] in the map after the last scan
  double beacons_found = kNone;           ///< [1] (BeaconScores)
  double beacon_rms = kNone;              ///< [m]
  double beacon_aligned_rms = kNone;      ///< [m]
  double landmark_rms = kNone;            ///< [m] of the final map by identity (MapScores)
  double landmark_nees = kNone;           ///< [1] of two components, mean over landmarks
  double joint_nees = kNone;              ///< [1] per component of pose and map together
  double gospa = kNone;                   ///< [m] (Gospa)
  double gospa_localisation = kNone;      ///< [m]
  double landmarks_missed = kNone;        ///< [1]
  double landmarks_invented = kNone;      ///< [1]
  double numerical_faults = kNone;        ///< [1] sum over scans
  double cpu_seconds = kNone;             ///< [s]
};

RunScores scores_of(const RunRows& rows, const RunMetrics& metrics);

/// How many doublings (or halvings) an average NEES of `dimension` components is away from that of
/// an honest filter: |log2(nees / dimension)|, 0 where they agree.
double nees_distance(double nees, std::size_t dimension);

/// Which of two values of a score is the better one; neither: the lower one is counted, no more.
enum class Better { lower, higher, neither };

/// A score under the name that files and studies give it.
struct ScoreName {
  const char* name;   ///< e.g. "position_rmse"
  const char* units;  ///< UDUNITS style, "1" where there is none
  const char* words;  ///< for tables
  double RunScores::*value;
  Better better = Better::lower;
};

/// All of them.
std::span<const ScoreName> score_names();

}  // namespace montecarta
