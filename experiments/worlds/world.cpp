// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/worlds/world.hpp"

#include "engine/errors.hpp"

#include <cmath>

namespace montecarta::experiments {
namespace {

void check_points(const std::vector<Eigen::Vector2d>& points, const std::string& place,
                  const std::string& noun) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].allFinite() && points[i].cwiseAbs().maxCoeff() <= kFarthestCoordinate) continue;
    throw StudyError(place + ": " + noun + " " + std::to_string(i + 1) +
                     " is no place (a coordinate is not finite or beyond 1e6 m): correct it");
  }
}

}  // namespace

void check_world(const World& world, const std::string& place) {
  if (world.waypoints.size() < 2) {
    throw StudyError(place + ": " + std::to_string(world.waypoints.size()) +
                     " way-points (a drive needs at least two): add way-points");
  }
  if (world.landmarks.empty()) {
    throw StudyError(place + ": no landmarks (there is nothing to map): add at least one");
  }
  check_points(world.waypoints, place, "way-point");
  check_points(world.landmarks, place, "landmark");
}

}  // namespace montecarta::experiments
