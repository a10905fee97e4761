// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace montecarta::experiments {

/// Landmarks to map and way-points to drive along, in the map frame.
struct World {
  std::string name;  ///< name in studies: the name of the file without its ending
  std::vector<Eigen::Vector2d> waypoints;  ///< [m] way-points in the order in which they are driven
  std::vector<Eigen::Vector2d> landmarks;  ///< [m], ordered by identity
  /// "file:line" of each way-point, for errors; empty if the world was not read from lines.
  std::vector<std::string> waypoint_places = {};
};

/// Bound on coordinates [m]. A larger one is a mistake of units.
inline constexpr double kFarthestCoordinate = 1e6;

/// Adds a landmark or a waypoint, as `kind` says, to `world`. Throws StudyError that begins with
/// `place`, e.g. "file:line", if it is neither.
void add_point(std::string_view kind, const Eigen::Vector2d& point, const std::string& place,
               World& world);

/// Throws StudyError "place: problem (why): remedy" unless `world` has landmarks, at least two
/// way-points, and valid coordinates.
void check_world(const World& world, const std::string& place);

/// Reads a world from a .csv file with the header `kind,x,y`, where kind is landmark or waypoint
/// and # begins a comment. Throws StudyError with file and line if it is missing or malformed.
World read_world_file(const std::filesystem::path& path);

/// Finds the world that a study calls `name`: a .csv file below one of `folders`, at that path
/// itself, or a shipped world.
World find_world(const std::string& name, const std::vector<std::filesystem::path>& folders = {});

/// Names of the shipped worlds, in alphabetical order.
std::vector<std::string> shipped_worlds();

}  // namespace montecarta::experiments
