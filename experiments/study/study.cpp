// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/study.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/text/list_text.hpp"
#include "experiments/files/files.hpp"
#include "experiments/study/fixes.hpp"
#include "experiments/study/known_map.hpp"
#include "experiments/study/read_drives.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>

namespace montecarta::experiments {
namespace {

Eigen::Vector2d read_point(const IniEntry& entry) {
  const std::vector<std::string> parts = split(entry.value, ',');
  const auto x = to_number(parts.front());
  const auto y = to_number(parts.back());
  if (parts.size() == 2 && x && y) return {*x, *y};
  throw StudyError("{}: {} = {} (two coordinates in metres are needed): write e.g. {} = 12.5, -3",
                   entry.place, entry.key, entry.value, entry.key);
}

std::string lines_of(const std::string& kind, const std::vector<Eigen::Vector2d>& points) {
  std::string text;
  for (const Eigen::Vector2d& point : points) {
    text += formatted("{} = {}, {}\n", kind, to_text(point.x()), to_text(point.y()));
  }
  return text;
}

/// Returns whether the study contains its world: [world] with `waypoint = x, y` and `landmark = x,
/// y` lines [m].
bool has_inline_world(const IniText& ini) {
  return std::ranges::any_of(ini.entries,
                             [](const IniEntry& entry) { return entry.section == "world"; });
}

World read_inline_world(const IniText& ini, const std::string& name, const std::string& place) {
  World world{.name = name, .waypoints = {}, .landmarks = {}};
  for (const IniEntry& entry : ini.entries) {
    if (entry.section == "world") add_point(entry.key, read_point(entry), entry.place, world);
  }
  check_world(world, place);
  return world;
}

void refuse_unknown_sections(const IniText& ini) {
  const std::vector<std::string> known = study_sections();
  for (const IniSection& section : ini.sections) {
    item_called(section.name, known, std::identity(),
                formatted("{}: unknown section [{}] (it would have no effect)", section.place,
                          section.name));
  }
}

IniEntry override_entry(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::size_t dot = text.find('.');
  if (equals == std::string::npos || dot == std::string::npos || dot > equals) {
    throw StudyError(
        "--set {}: not understood (the form is section.key=value): write e.g. --set study.runs=10, "
        "and change cells in the study file",
        text);
  }
  if (text.find_first_of("#\n\r") != std::string::npos) {
    throw StudyError(
        "--set {}: the value holds # or a new line (no study file could): leave it out", text);
  }
  const std::string_view whole = text;
  return {std::string(trimmed(whole.substr(0, dot))),
          std::string(trimmed(whole.substr(dot + 1, equals - dot - 1))),
          std::string(trimmed(whole.substr(equals + 1))), "--set " + text.substr(0, equals)};
}

/// Applies overrides, which replace entries of the file with the same key. Several overrides of one
/// key are reported as an error later.
void apply(std::span<const std::string> overrides, IniText& ini) {
  std::vector<IniEntry> entries;
  for (const std::string& text : overrides) {
    entries.push_back(override_entry(text));
    ini.sections.push_back({entries.back().section, entries.back().place});
  }
  for (const IniEntry& entry : entries) {
    std::erase_if(ini.entries, [&](const IniEntry& old) {
      return old.section == entry.section && old.key == entry.key;
    });
  }
  ini.entries.insert(ini.entries.end(), entries.begin(), entries.end());
}

/// The world that is written in the study, otherwise the one that it names.
World world_of(const IniText& ini, const Settings& settings, const std::filesystem::path& folder) {
  const std::string& name = settings.text("scenario", "world");
  const std::string& place = settings.place("scenario", "world");
  if (has_inline_world(ini)) return read_inline_world(ini, name, place);
  return at_place(formatted("{}: scenario.world = {}", place, name),
                  [&] { return find_world(name, {folder}); });
}

/// A setting that has no effect and is left out, so that the fingerprints of studies without it do
/// not change.
struct SilentSetting {
  std::string section, key, value;
  /// The setting is left out only if this one has this value or does not apply.
  struct Other {
    std::string section, key, value;
  };
  std::optional<Other> if_too = {};

  bool applies(const Settings& settings) const {
    return !if_too || !settings.has(if_too->section, if_too->key) ||
           settings.text(if_too->section, if_too->key) == if_too->value;
  }
};

bool is_silent(const Settings& settings, const std::string& section, const std::string& key,
               const std::string& value) {
  static const std::vector<SilentSetting> silent{
      {"study", "until", ""},
      {"study", "judge_from", "0"},
      {"record", "full_runs", "0"},
      {"scenario", "map_sigma_m", "0"},
      {"scenario", "start_sigma_m", "0"},
      {"scenario", "start_sigma_deg", "0"},
      {"scenario", "pilot", "closed_loop", {{"scenario", "noise", "measured-control"}}},
      {"scenario", "increment_noise", "none"},
      {"belief", "increment_noise", "none", {{"scenario", "increment_noise", "none"}}},
      {"scenario", "fixes", "none"},
      {"belief", "map", "estimated"}};
  return std::ranges::any_of(silent, [&](const SilentSetting& one) {
    return one.section == section && one.key == key && one.value == value && one.applies(settings);
  });
}

/// Refuses a pilot that would drive as another one does.
void refuse_pilot(const Settings& settings) {
  if (settings.scenario_kind() != "simulated" || settings.text("scenario", "noise") == "matched")
    return;
  if (settings.text("scenario", "pilot") != "open_loop") return;
  throw StudyError(settings.place("scenario", "pilot") +
                   ": pilot = open_loop with noise = measured-control (the vehicle obeys its "
                   "controls, so that it drives as in closed_loop): remove it, or set noise = "
                   "matched");
}

void refuse_world(const IniText& ini, const Settings& settings) {
  if (!has_inline_world(ini)) return;
  throw StudyError(
      "{}: scenario.kind = {} has its own world, and the study a [world] (it would have no "
      "effect): remove [world]",
      settings.place("scenario", "kind"), settings.scenario_kind());
}

}  // namespace

Study parse_study(const std::string& text, const std::string& name,
                  const std::filesystem::path& folder, std::span<const FilterKind> filters,
                  std::span<const std::string> overrides) {
  IniText ini = read_ini(text, name);
  apply(overrides, ini);
  refuse_unknown_sections(ini);
  refuse_options_outside_cells(ini.entries, filters);
  const Settings settings(ini.entries, name);
  const bool controls_are_measured = settings.scenario_kind() == "simulated" &&
                                     settings.text("scenario", "noise") == "measured-control";
  Study study{settings, read_cells(ini.entries, name, filters, controls_are_measured), {}, {}, {},
              {}};
  if (study.settings.scenario_kind() == "simulated") {
    study.world = world_of(ini, study.settings, folder);
    study.settings.replace("scenario", "world", study.world.name);
  } else {
    refuse_world(ini, study.settings);
    RecordedDrives drives = read_drives_of(study.settings, folder);
    study.logs = std::move(drives.logs);
    study.log_folders = std::move(drives.folders);
    const bool is_given = study.settings.place("association", "kind") != name;
    if (!is_given && identities_of(study) > 0)
      study.settings.replace("association", "kind", "known");
  }
  refuse_sensors(study.settings, study.cells, filters);
  refuse_known_map(study.settings, study.cells, filters, landmarks_of(study).size());
  refuse_fixes(study.settings, study.cells, filters);
  refuse_pilot(study.settings);
  study.until = parse_stopping_rule(study.settings.text("study", "until"),
                                    study.settings.place("study", "until"));
  if (study.until) study.settings.replace("study", "until", text_of(*study.until));
  if (study.settings.text("study", "title").empty()) {
    study.settings.replace("study", "title", study.settings.text("study", "name"));
  }
  return study;
}

const std::vector<Eigen::Vector2d>& landmarks_of(const Study& study) {
  return study.logs.empty() ? study.world.landmarks : study.logs.front()->landmarks;
}

std::size_t identities_of(const Study& study) {
  if (study.logs.empty()) return study.world.landmarks.size();
  std::size_t most = 0;
  for (const auto& log : study.logs) most = std::max(most, identities_in(*log));
  return most;
}

Study read_study(const std::filesystem::path& path, std::span<const FilterKind> filters,
                 std::span<const std::string> overrides) {
  return parse_study(text_file(path), path.string(), path.parent_path(), filters, overrides);
}

std::vector<std::pair<std::string, std::string>> stated_settings(const Settings& settings,
                                                                 const std::string& section) {
  auto stated = settings.section(section);
  std::erase_if(stated, [&](const auto& pair) {
    return is_silent(settings, section, pair.first, pair.second);
  });
  return stated;
}

std::string resolved_text(const Study& study) {
  std::string text;
  for (const std::string& section : study_sections()) {
    if (section == "world" && !study.logs.empty()) continue;
    text += formatted("[{}]\n", section);
    for (const auto& [key, value] : stated_settings(study.settings, section))
      text += formatted("{} = {}\n", key, value);
    if (section == "cells") {
      for (const CellSpec& cell : study.cells) text += formatted("cell = {}\n", cell_line(cell));
    }
    if (section == "world") {
      text += lines_of("waypoint", study.world.waypoints);
      text += lines_of("landmark", study.world.landmarks);
    }
  }
  return text;
}

std::vector<std::string> settings_beside_text(const Study& study) {
  if (study.log_folders.empty()) return {};
  std::vector<std::string> paths;
  for (const std::filesystem::path& folder : study.log_folders) paths.push_back(folder.string());
  return {"scenario.path=" + joined(paths)};
}

}  // namespace montecarta::experiments
