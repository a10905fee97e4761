// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/reference_scores.hpp"
#include "analysis/run/run_rows.hpp"
#include "analysis/statistics/spread.hpp"
#include "filters/models/field_of_view.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// {row} Column in the assignment of least total cost. `cost` is finite, with no more rows than
/// columns. The method is that of shortest augmenting paths (Jonker and Volgenant 1987): at most
/// cubic, and quadratic if most rows have a cheapest column of their own, as in a good map.
std::vector<std::size_t> cheapest_assignment(const Eigen::MatrixXd& cost);

/// A landmark farther than this [m] from its true position counts as missed and spurious.
inline constexpr double kGospaCutoff = 5.0;

/// Distance between a map and the truth, independent of identities (Rahmathullah, Garcia-Fernandez,
/// Svensson 2017; alpha = 2, p = 2): distance^2 = localisation^2 + cutoff^2 / 2 (missed +
/// spurious).
struct Gospa {
  double distance = 0.0;      ///< [m] GOSPA distance between map and truth
  double localisation = 0.0;  ///< [m] root of the sum of squared errors of the pairs
  double missed = 0.0;        ///< [1] number of true landmarks without a partner
  double spurious = 0.0;      ///< [1] number of landmarks of the map without a partner
};

/// Pairs `map` [m] and `truth` [m] at the least distance. A point that is not finite has no
/// partner.
Gospa gospa(std::span<const Eigen::Vector2d> map, std::span<const Eigen::Vector2d> truth,
            double cutoff = kGospaCutoff);

/// Facts by which the final maps of a study are judged.
struct MapCriteria {
  bool known = false;  ///< whether the true positions are known
  /// Field of view of the sensor; without it all landmarks count as seen.
  std::optional<FieldOfView> view = {};
  bool identities_known = false;  ///< whether rows of a map are identities of the world
  bool is_exact = false;  ///< whether the filters are given a map that they assume to be exact
};

/// Scores of one landmark in one run; NaN where it is not in the map.
struct LandmarkScore {
  double squared_error = kNaN;  ///< [m^2] squared position error
  double nees = kNaN;           ///< [1] NEES of two components
  bool in_map = false;
};

/// Scores of the final map of a run against the true landmarks that came into view during the run.
struct MapScores {
  Gospa gospa;
  /// [m] RMS position error of the landmarks in the map; NaN without identities.
  double rms = kNaN;
  /// [m] root of the mean trace of the covariances that the filter has of them.
  double deviation = kNaN;
  double nees = kNaN;                    ///< [1] mean NEES of the landmarks that have one
  std::size_t undefined = 0;             ///< number of landmarks in the map that have no NEES
  std::vector<LandmarkScore> landmarks;  ///< {landmark}; empty where identities are unknown
};

/// Scores of `map`. `landmarks` are the true positions [m], `path` the true poses at scans {scan,
/// 3} [m, m, rad].
MapScores map_scores(const FinalMap& map, const MapCriteria& criteria,
                     std::span<const Eigen::Vector2d> landmarks, std::span<const double> path);

/// A surveyed beacon is found where an aligned landmark lies within this distance [m].
inline constexpr double kFoundWithin = 1.0;

/// Scores of the final map of a run against surveyed beacons. The distances are NaN if no
/// beacon was found.
struct BeaconScores {
  double found = 0.0;         ///< [1] number of beacons found
  double rms = kNaN;          ///< [m] RMS distance of the beacons found
  double aligned_rms = kNaN;  ///< [m] RMS distance of the beacons found, after alignment
};

/// Pairs each beacon [m] with the nearest landmark of `map` [m] after `alignment`, the motion that
/// aligns the path with its reference, because the start of a drive is not known exactly. A
/// landmark counts for one beacon only; the nearest pairs are formed first.
BeaconScores beacon_scores(std::span<const Eigen::Vector2d> map,
                           std::span<const Eigen::Vector2d> beacons, const RigidMotion& alignment);

}  // namespace montecarta::analysis
