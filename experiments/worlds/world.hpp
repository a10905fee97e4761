// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <filesystem>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// What there is to map and where to drive, in the map frame.
struct World {
  std::string name;                        ///< as studies call it: the file's name without ending
  std::vector<Eigen::Vector2d> waypoints;  ///< [m], in the order in which they are driven
  std::vector<Eigen::Vector2d> landmarks;  ///< [m], by identity
  /// "file:line" of each way-point, for errors; empty if there are no lines.
  std::vector<std::string> waypoint_places = {};
};

/// A coordinate larger than this [m] is a mistake of units, not a place.
inline constexpr double kFarthestCoordinate = 1e6;

/// Throws StudyError "place: problem (why): remedy" unless `world` has landmarks, enough
/// way-points, and only places.
void check_world(const World& world, const std::string& place);

/// Reads a world from a .csv file (header `kind,x,y`, kind landmark or waypoint, # begins a
/// comment). Throws StudyError naming file and line where it is missing or malformed.
World read_world_file(const std::filesystem::path& path);

/// Reads the world that a study calls `name`: a path to a .csv file, tried below each of
/// `folders` and then as it stands, or else a shipped world.
World find_world(const std::string& name, const std::vector<std::filesystem::path>& folders = {});

/// Names of the worlds that come with montecarta, in alphabetical order.
std::vector<std::string> shipped_worlds();

}  // namespace montecarta::experiments
