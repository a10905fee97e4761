// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/data/run_rows.hpp"
#include "analysis/metrics/reference_scores.hpp"
#include "filters/models/field_of_view.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// The cheapest way to give every row a column of its own: which one, row by row. `cost` is finite,
/// with no more rows than columns. Shortest augmenting paths (Jonker and Volgenant 1987), at most
/// cubic; quadratic where most rows have a cheapest column to themselves, as a good map has.
std::vector<std::size_t> cheapest_assignment(const Eigen::MatrixXd& cost);

/// A landmark farther than this [m] from where it is believed to be counts as missed and spurious.
inline constexpr double kGospaCutoff = 5.0;

/// How far a map is from the truth, whoever is who (Rahmathullah, Garcia-Fernandez, Svensson 2017;
/// alpha = 2, p = 2): distance^2 = localisation^2 + cutoff^2 / 2 (missed + spurious).
struct Gospa {
  double distance = 0.0;      ///< [m]
  double localisation = 0.0;  ///< [m] root of the sum of squared errors of the pairs
  double missed = 0.0;        ///< [1] true landmarks without a partner
  double spurious = 0.0;      ///< [1] landmarks of the map without a partner
};

/// Pairs `map` [m] and `truth` [m] at the least distance. A point that is not finite has no
/// partner.
Gospa gospa(std::span<const Eigen::Vector2d> map, std::span<const Eigen::Vector2d> truth,
            double cutoff = kGospaCutoff);

/// What the final maps of a study are judged by.
struct MapCriteria {
  bool known = false;               ///< whether anybody knows where the landmarks really are
  std::optional<FieldOfView> view;  ///< of the sensor; without it all count as seen
  bool identities_known = false;    ///< rows of a map are identities of the world
};

/// One landmark of one run; NaN where it is not in the map.
struct LandmarkScore {
  double squared_error = std::numeric_limits<double>::quiet_NaN();  ///< [m^2]
  double nees = std::numeric_limits<double>::quiet_NaN();           ///< [1] of two components
  bool in_map = false;
};

/// The final map of a run against the true landmarks that came into view in it.
struct MapScores {
  Gospa gospa;
  double rms = std::numeric_limits<double>::quiet_NaN();   ///< [m] over the landmarks in the map;
                                                           ///< by identity: NaN where unknown
  double nees = std::numeric_limits<double>::quiet_NaN();  ///< [1] mean over those with a NEES
  std::size_t undefined = 0;             ///< landmarks in the map whose NEES is not a number
  std::vector<LandmarkScore> landmarks;  ///< {landmark}; empty where identities are unknown
};

/// `landmarks`: [m] where they really are. `path`: true poses at scans {scan, 3} [m, m, rad].
MapScores map_scores(const FinalMap& map, const MapCriteria& criteria,
                     std::span<const Eigen::Vector2d> landmarks, std::span<const double> path);

/// A surveyed beacon is found where an aligned landmark lies within this distance [m].
inline constexpr double kFoundWithin = 1.0;

/// A run's final map against beacons whose positions were surveyed. NaN where nothing was found.
struct BeaconScores {
  double found = 0.0;                                             ///< [1] beacons
  double rms = std::numeric_limits<double>::quiet_NaN();          ///< [m] of those found
  double aligned_rms = std::numeric_limits<double>::quiet_NaN();  ///< [m] of those found, aligned
};

/// Pairs each beacon [m] with the nearest landmark of `map` [m] after `alignment`, the motion that
/// brings the path onto its reference: where a drive began nobody knows exactly. A landmark counts
/// for one beacon only, the nearer pair first.
BeaconScores beacon_scores(std::span<const Eigen::Vector2d> map,
                           std::span<const Eigen::Vector2d> beacons, const RigidMotion& alignment);

}  // namespace montecarta::analysis
