// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/text_table.hpp"
#include "engine/errors.hpp"
#include "engine/records/columns.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/external/external_filter.hpp"
#include "experiments/files/files.hpp"
#include "experiments/study/cell_spec.hpp"
#include "experiments/study/settings.hpp"
#include "experiments/text/words.hpp"
#include "experiments/worlds/world.hpp"
#include "filters/models/vehicle_settings.hpp"

#include <algorithm>
#include <fstream>
#include <iostream>
#include <sstream>

namespace montecarta::experiments {
namespace {

/// The default, and the one of measured controls where it is another.
std::string fallback_text(const Parameter& option) {
  std::string text = option.fallback.value_or("(required)");
  if (option.fallback_if_measured) text += "; measured-control: " + *option.fallback_if_measured;
  return text;
}

void list_options(std::span<const Parameter> options) {
  std::vector<TableRow> rows;
  for (const Parameter& option : options) {
    rows.push_back({option.key + "=" + fallback_text(option), option.meaning, demand_of(option)});
  }
  std::cout << aligned(rows, 4);
}

void list_filters() {
  for (const FilterKind& filter : known_filters()) {
    std::cout << filter.name << "  " << filter.long_name << "  " << filter.source << "\n";
    list_options(filter.options);
  }
  std::cout << "every filter  given wrong noise, to see what it makes of it\n";
  list_options(mismatch_options());
}

/// The default, and those of kinds of scenario that have another.
std::string fallback_text(const Setting& setting) {
  std::string text = setting.fallback.value_or("(required)");
  for (const auto& [kind, value] : setting.fallback_of_kind) text += "; " + kind + ": " + value;
  return text;
}

std::string meaning_of(const Setting& setting) {
  std::string meaning = setting.meaning;
  const bool is_of_all =
      setting.applies_to == (setting.chooser == "sensor" ? sensor_names() : vehicle_names());
  if (!setting.applies_to.empty() && !is_of_all) meaning += " (" + joined(setting.applies_to) + ")";
  if (!setting.kinds.empty()) meaning += " (" + joined(setting.kinds) + ")";
  return meaning;
}

/// The settings of the given sections with unit, default and meaning.
void list_settings(const std::vector<std::string>& sections) {
  std::vector<TableRow> rows;
  for (const Setting& setting : study_settings()) {
    if (std::ranges::find(sections, setting.section) == sections.end()) continue;
    rows.push_back({setting.section + "." + setting.key, fallback_text(setting), setting.unit,
                    meaning_of(setting)});
  }
  std::cout << aligned(rows, 0);
}

/// Worlds with their size, then what a scenario may set.
void list_scenarios() {
  std::vector<TableRow> rows;
  for (const std::string& name : shipped_worlds()) {
    const World world = find_world(name);
    rows.push_back({"world = " + name, std::to_string(world.landmarks.size()) + " landmarks",
                    std::to_string(world.waypoints.size()) + " way-points"});
  }
  std::cout << "simulated: way-points, range and bearing (EQUATIONS 1)\n" << aligned(rows);
  list_settings({"scenario"});
}

std::string title_of(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  const IniText ini = read_ini(text.str(), path.string());
  const auto found = std::ranges::find_if(
      ini.entries, [](const IniEntry& e) { return e.section == "study" && e.key == "title"; });
  return found == ini.entries.end() ? "" : found->value;
}

void list_studies() {
  std::vector<TableRow> rows;
  for (const std::string& name : shipped_names("studies", ".ini")) {
    const auto path = shipped_file("studies", name + ".ini").value();
    rows.push_back({path.string(), title_of(path)});
  }
  std::cout << aligned(rows, 0);
}

/// "{run, scan, particle}"
std::string axes_of(const ColumnKind& kind) {
  std::string axes = "{run";
  for (const Axis axis : kind.axes) axes.append(", ").append(name_of(axis));
  return axes + "}";
}

std::string unit_of(const ColumnKind& kind) {
  const std::string units = kind.units;
  return units == "1" ? "" : " [" + units + "]";
}

void list_columns() {
  std::vector<TableRow> rows;
  for (const ColumnGroup& group : column_groups()) {
    for (const ColumnKind& kind : column_table()) {
      if (std::string_view(kind.group) != group.name) continue;
      rows.push_back({group.name, kind.name, axes_of(kind), kind.long_name + unit_of(kind)});
    }
  }
  std::cout << "record.columns, the columns that each name stores, and what they hold (pose is "
               "always stored):\n"
            << aligned(rows, 0);
}

int list(const Arguments& arguments) {
  const std::vector<std::string> known = {"filters", "scenarios", "studies", "columns", "settings"};
  const std::string& what = arguments.operands().front();
  if (what == "filters") return list_filters(), kDone;
  if (what == "scenarios") return list_scenarios(), kDone;
  if (what == "studies") return list_studies(), kDone;
  if (what == "columns") return list_columns(), kDone;
  if (what == "settings") return list_settings(study_sections()), kDone;
  throw StudyError(what + ": nothing to list (one of " + joined(known) +
                   "): " + nearest_spelling(what, known));
}

}  // namespace

Command list_command() {
  return {{.name = "list",
           .summary = "lists filters, scenarios, studies, columns or settings, one line each",
           .operands = {{"filters|scenarios|studies|columns|settings"}},
           .options = {},
           .details = {}},
          list};
}

}  // namespace montecarta::experiments
