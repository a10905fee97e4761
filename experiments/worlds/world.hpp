// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <string>
#include <vector>

namespace montecarta::experiments {

/// What there is to map and where to drive, in the map frame.
struct World {
  std::string name;                        ///< as studies call it: the file's name without ending
  std::vector<Eigen::Vector2d> waypoints;  ///< [m], in the order in which they are driven
  std::vector<Eigen::Vector2d> landmarks;  ///< [m], by identity
};

/// A coordinate larger than this [m] is a mistake of units, not a place.
inline constexpr double kFarthestCoordinate = 1e6;

/// Throws StudyError "place: problem (why): remedy" unless `world` has landmarks, enough
/// way-points, and only places.
void check_world(const World& world, const std::string& place);

}  // namespace montecarta::experiments
