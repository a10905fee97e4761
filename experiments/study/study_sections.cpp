// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/study_sections.hpp"

#include "analysis/printed/run_samples.hpp"
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

void refuse_unknown(const std::string& what, const std::string& name,
                    std::span<const std::string> known) {
  if (std::ranges::find(known, name) != known.end()) return;
  throw StudyError("there is no " + what + " '" + name + "': " + nearest_spelling(name, known));
}

void check(const PrintedValue& value, std::span<const std::string> labels) {
  refuse_unknown("metric", value.metric, printed_metrics());
  refuse_unknown("cell", value.cell, labels);
  if (value.relative_to.empty()) return;
  refuse_unknown("cell", value.relative_to, labels);
  if (is_run_metric(value.metric)) return;
  throw StudyError("relative_to=" + value.relative_to + " (runs have no " + value.metric +
                   " each): remove it");
}

void check(const PrintedClaim& claim, std::span<const std::string> labels) {
  refuse_unknown("metric", claim.metric, printed_metrics());
  refuse_unknown("cell", claim.left, labels);
  refuse_unknown("cell", claim.right, labels);
}

void take(const IniEntry& entry, std::span<const std::string> labels, Printed& printed) {
  try {
    take_printed_line(entry.key, entry.value, printed);
    if (entry.key == "value") check(printed.values.back(), labels);
    if (entry.key == "claim") check(printed.claims.back(), labels);
    if (entry.key == "baseline") refuse_unknown("cell", printed.baseline, labels);
  } catch (const StudyError& error) {
    throw StudyError(entry.place + ": " + entry.key + ": " + error.what());
  }
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

Printed read_printed(std::span<const IniEntry> entries, std::span<const CellSpec> cells) {
  std::vector<std::string> labels;
  for (const CellSpec& cell : cells) labels.push_back(cell.label);
  Printed printed;
  for (const IniEntry& entry : entries) {
    if (entry.section == "printed") take(entry, labels, printed);
  }
  return printed;
}

}  // namespace montecarta::experiments
