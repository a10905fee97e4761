// SPDX-License-Identifier: BSD-3-Clause
#include "engine/errors.hpp"
#include "experiments/files/csv_rows.hpp"
#include "experiments/text/words.hpp"
#include "experiments/worlds/world_file.hpp"

#include <array>
#include <string>

namespace montecarta::experiments {
namespace {

const std::array<std::string, 2> kKinds = {"landmark", "waypoint"};

void read_row(const CsvRows& rows, World& world) {
  const std::string kind(rows.field(0));
  if (kind != kKinds[0] && kind != kKinds[1]) {
    throw StudyError(rows.place() + ": unknown kind '" + excerpt(kind) +
                     "' (a row is a landmark or a waypoint): " + nearest_spelling(kind, kKinds));
  }
  auto& points = kind == kKinds[0] ? world.landmarks : world.waypoints;
  points.emplace_back(rows.number(1, "coordinate"), rows.number(2, "coordinate"));
}

}  // namespace

World read_world_csv(const std::filesystem::path& path) {
  World world{.name = path.stem().string(), .waypoints = {}, .landmarks = {}};
  CsvRows rows(path, std::array<std::string, 1>{"kind,x,y"});
  while (rows.next()) read_row(rows, world);
  check_world(world, path.string());
  return world;
}

}  // namespace montecarta::experiments
