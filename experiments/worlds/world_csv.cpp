// SPDX-License-Identifier: BSD-3-Clause
#include "engine/errors.hpp"
#include "experiments/text/numbers.hpp"
#include "experiments/text/words.hpp"
#include "experiments/worlds/world_file.hpp"

#include <array>
#include <fstream>

namespace montecarta {
namespace {

const std::array<std::string, 2> kKinds = {"landmark", "waypoint"};

double coordinate(const std::string& text, const std::string& place) {
  const std::optional<double> value = to_number(text);
  if (value) return *value;
  throw StudyError(place + ": '" + text +
                   "' is no coordinate (a finite number is needed): write metres, e.g. 12.5");
}

void read_row(const std::string& row, const std::string& place, World& world) {
  const std::vector<std::string> fields = split(row, ',');
  if (fields.size() != 3) {
    throw StudyError(place + ": " + std::to_string(fields.size()) +
                     " fields (a row is kind,x,y): write e.g. landmark,12.5,-3");
  }
  if (fields[0] != kKinds[0] && fields[0] != kKinds[1]) {
    throw StudyError(
        place + ": unknown kind '" + fields[0] +
        "' (a row is a landmark or a waypoint): " + nearest_spelling(fields[0], kKinds));
  }
  auto& points = fields[0] == kKinds[0] ? world.landmarks : world.waypoints;
  points.emplace_back(coordinate(fields[1], place), coordinate(fields[2], place));
}

/// Spreadsheets mark UTF-8 by three bytes in front.
void skip_byte_order_mark(std::string& line) {
  if (line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
}

/// The part of a line before a comment.
std::string content_of(const std::string& line) {
  return std::string(trimmed(std::string_view(line).substr(0, line.find('#'))));
}

}  // namespace

World read_world_csv(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file)
    throw StudyError(path.string() +
                     ": cannot be opened (is it there, and readable?): check the path");
  World world{.name = path.stem().string(), .waypoints = {}, .landmarks = {}};
  bool headed = false;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (number == 1) skip_byte_order_mark(line);
    const std::string row = content_of(line);
    const std::string place = path.string() + ":" + std::to_string(number);
    if (row.empty()) continue;
    if (headed) {
      read_row(row, place, world);
    } else if (row != "kind,x,y") {
      throw StudyError(place + ": '" + row +
                       "' is not the header (a world file names its columns): begin with kind,x,y");
    }
    headed = true;
  }
  check_world(world, path.string());
  return world;
}

}  // namespace montecarta
