// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/worlds/world.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/text/list_text.hpp"
#include "experiments/files/files.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <array>

namespace montecarta::experiments {
namespace {

void check_points(const std::vector<Eigen::Vector2d>& points, const std::string& place,
                  const std::string& noun) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].allFinite() && points[i].cwiseAbs().maxCoeff() <= kFarthestCoordinate) continue;
    throw StudyError(
        "{}: {} {} is no place (a coordinate is not finite or beyond 1e6 m): correct it", place,
        noun, i + 1);
  }
}

namespace fs = std::filesystem;

bool is_path(const std::string& name) {
  return name.find('/') != std::string::npos || fs::path(name).has_extension();
}

/// The path `name` in the first of `folders` in which it exists, otherwise `name` itself.
fs::path resolved_path(const std::string& name, const std::vector<fs::path>& folders) {
  for (const fs::path& folder : folders) {
    if (fs::exists(folder / name)) return folder / name;
  }
  return name;
}

}  // namespace

void add_point(std::string_view kind, const Eigen::Vector2d& point, const std::string& place,
               World& world) {
  static const std::array<std::string, 2> kinds = {"landmark", "waypoint"};
  item_called(
      kind, kinds, std::identity(),
      formatted("{}: unknown kind '{}' (a world has landmark and waypoint)", place, excerpt(kind)));
  if (kind == kinds[0]) return world.landmarks.push_back(point);
  world.waypoints.push_back(point);
  world.waypoint_places.push_back(place);
}

void check_world(const World& world, const std::string& place) {
  if (world.waypoints.size() < 2) {
    throw StudyError("{}: {} way-points (a drive needs at least two): add way-points", place,
                     world.waypoints.size());
  }
  if (world.landmarks.empty()) {
    throw StudyError(place + ": no landmarks (there is nothing to map): add at least one");
  }
  check_points(world.waypoints, place, "way-point");
  check_points(world.landmarks, place, "landmark");
}

World read_world_file(const fs::path& path) {
  if (!fs::exists(path)) {
    throw StudyError(
        "{}: no such world file (looked from here and from the study's folder): correct the path, "
        "or name a shipped world: {}",
        path, joined(shipped_worlds()));
  }
  if (path.extension() != ".csv") {
    throw StudyError(path.string() +
                     ": is not called .csv (a world is a CSV file): convert a MATLAB map by "
                     "experiments/convert/world.py, or rename the file");
  }
  World world{.name = path.stem().string(), .waypoints = {}, .landmarks = {}};
  CsvRows rows(path, std::array<std::string, 1>{"kind,x,y"});
  while (rows.next()) {
    add_point(rows.field(0), {rows.number(1, "coordinate"), rows.number(2, "coordinate")},
              rows.place(), world);
  }
  check_world(world, path.string());
  return world;
}

World find_world(const std::string& name, const std::vector<fs::path>& folders) {
  if (is_path(name)) return read_world_file(resolved_path(name, folders));
  if (const auto shipped = shipped_file("worlds", name + ".csv")) return read_world_file(*shipped);
  throw StudyError("unknown world '{}' (neither shipped nor a path to a .csv file): {}", name,
                   nearest_spelling(name, shipped_worlds()));
}

std::vector<std::string> shipped_worlds() { return shipped_names("worlds", ".csv"); }

}  // namespace montecarta::experiments
