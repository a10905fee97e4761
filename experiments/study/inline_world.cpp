// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/inline_world.hpp"

#include "engine/errors.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <array>

namespace montecarta::experiments {
namespace {

const std::array<std::string, 2> kPointKeys = {"waypoint", "landmark"};

Eigen::Vector2d read_point(const IniEntry& entry) {
  const std::vector<std::string> parts = split(entry.value, ',');
  const auto x = to_number(parts.front());
  const auto y = to_number(parts.back());
  if (parts.size() == 2 && x && y) return {*x, *y};
  throw StudyError(entry.place + ": " + entry.key + " = " + entry.value +
                   " (two coordinates in metres are needed): write e.g. " + entry.key +
                   " = 12.5, -3");
}

std::string lines_of(const std::string& kind, const std::vector<Eigen::Vector2d>& points) {
  std::string text;
  for (const Eigen::Vector2d& point : points) {
    text += kind + " = " + to_text(point.x()) + ", " + to_text(point.y()) + "\n";
  }
  return text;
}

}  // namespace

bool has_inline_world(const IniText& ini) {
  return std::ranges::any_of(ini.entries,
                             [](const IniEntry& entry) { return entry.section == "world"; });
}

World read_inline_world(const IniText& ini, const std::string& name, const std::string& place) {
  World world{.name = name, .waypoints = {}, .landmarks = {}};
  for (const IniEntry& entry : ini.entries) {
    if (entry.section != "world") continue;
    if (entry.key != kPointKeys[0] && entry.key != kPointKeys[1]) {
      throw StudyError(
          entry.place + ": unknown key world." + entry.key +
          " (a world has waypoint and landmark): " + nearest_spelling(entry.key, kPointKeys));
    }
    if (entry.key == kPointKeys[0]) world.waypoint_places.push_back(entry.place);
    (entry.key == kPointKeys[0] ? world.waypoints : world.landmarks).push_back(read_point(entry));
  }
  check_world(world, place);
  return world;
}

std::string inline_world_text(const World& world) {
  return lines_of(kPointKeys[0], world.waypoints) + lines_of(kPointKeys[1], world.landmarks);
}

}  // namespace montecarta::experiments
