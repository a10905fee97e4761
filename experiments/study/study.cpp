// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/study.hpp"

#include "engine/errors.hpp"
#include "experiments/external/external_filter.hpp"
#include "experiments/files/files.hpp"
#include "experiments/study/cell_spec.hpp"
#include "experiments/study/make_drives.hpp"
#include "experiments/study/settings.hpp"
#include "experiments/text/words.hpp"
#include "experiments/worlds/world.hpp"

#include <algorithm>

namespace montecarta::experiments {
namespace {

void refuse_unknown_sections(const IniText& ini) {
  const std::vector<std::string> known = study_sections();
  for (const IniSection& section : ini.sections) {
    if (std::ranges::find(known, section.name) != known.end()) continue;
    throw StudyError(section.place + ": unknown section [" + section.name +
                     "] (nothing would come of it): " + nearest_spelling(section.name, known));
  }
}

IniEntry override_entry(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::size_t dot = text.find('.');
  if (equals == std::string::npos || dot == std::string::npos || dot > equals) {
    throw StudyError(
        "--set " + text +
        ": not understood (the form is section.key=value): write e.g. --set study.runs=10");
  }
  if (text.find_first_of("#\n\r") != std::string::npos) {
    throw StudyError("--set " + text +
                     ": the value holds # or a new line (no study file could): leave it out");
  }
  const std::string_view whole = text;
  return {std::string(trimmed(whole.substr(0, dot))),
          std::string(trimmed(whole.substr(dot + 1, equals - dot - 1))),
          std::string(trimmed(whole.substr(equals + 1))), "--set " + text.substr(0, equals)};
}

/// An override takes the place of what the file says of that key; several overrides of one key are
/// an error later.
void apply(std::span<const std::string> overrides, IniText& ini) {
  const std::size_t in_file = ini.entries.size();
  for (const std::string& text : overrides) {
    const IniEntry entry = override_entry(text);
    ini.sections.push_back({entry.section, entry.place});
    ini.entries.push_back(entry);
  }
  const auto overridden = [&](const IniEntry& old) {
    return std::any_of(
        ini.entries.begin() + static_cast<std::ptrdiff_t>(in_file), ini.entries.end(),
        [&](const IniEntry& e) { return e.section == old.section && e.key == old.key; });
  };
  std::vector<IniEntry> kept;
  for (std::size_t i = 0; i < ini.entries.size(); ++i) {
    if (i >= in_file || !overridden(ini.entries[i])) kept.push_back(ini.entries[i]);
  }
  ini.entries = std::move(kept);
}

/// The world that is written out in the study, else the one that it names.
World world_of(const IniText& ini, const Settings& settings, const std::filesystem::path& folder) {
  const std::string& name = settings.text("scenario", "world");
  const std::string& place = settings.place("scenario", "world");
  if (has_inline_world(ini)) return read_inline_world(ini, name, place);
  try {
    return find_world(name, {folder});
  } catch (const StudyError& error) {
    throw StudyError(place + ": scenario.world = " + name + ": " + error.what());
  }
}

void refuse_world(const IniText& ini, const Settings& settings) {
  if (!has_inline_world(ini)) return;
  throw StudyError(settings.place("scenario", "kind") +
                   ": scenario.kind = " + settings.scenario_kind() +
                   " has its own world, and the study a [world] (nothing would come of it): remove "
                   "[world]");
}

/// Where nothing is said of the association, and the log says which landmark each detection is of,
/// filters are told.
void use_identities(Study& study, const std::string& name) {
  const bool is_given = study.settings.place("association", "kind") != name;
  if (is_given || identities_of(study) == 0) return;
  study.settings.replace("association", "kind", "known");
}

}  // namespace

Study parse_study(const std::string& text, const std::string& name,
                  const std::filesystem::path& folder, std::span<const std::string> overrides) {
  IniText ini = read_ini(text, name);
  apply(overrides, ini);
  refuse_unknown_sections(ini);
  const Settings settings(ini.entries, name);
  const bool controls_are_measured = settings.scenario_kind() == "simulated" &&
                                     settings.text("scenario", "noise") == "measured-control";
  Study study{settings, read_cells(ini.entries, name, known_filters(), controls_are_measured),
              {},       {},
              {},       {}};
  if (study.settings.scenario_kind() == "simulated") {
    study.world = world_of(ini, study.settings, folder);
    study.settings.replace("scenario", "world", study.world.name);
  } else {
    refuse_world(ini, study.settings);
    study.own_logs = read_drives_of(study.settings, folder);
    study.log = study.own_logs.front();
    if (study.own_logs.size() == 1) study.own_logs.clear();
    use_identities(study, name);
  }
  refuse_sensors(study.settings, study.cells);
  study.until =
      parse_until(study.settings.text("study", "until"), study.settings.place("study", "until"));
  if (study.until) study.settings.replace("study", "until", text_of(*study.until));
  if (study.settings.text("study", "title").empty()) {
    study.settings.replace("study", "title", study.settings.text("study", "name"));
  }
  return study;
}

Study read_study(const std::filesystem::path& path, std::span<const std::string> overrides) {
  return parse_study(text_file(path), path.string(), path.parent_path(), overrides);
}

std::string resolved_text(const Study& study) {
  std::string text;
  for (const std::string& section : study_sections()) {
    if (section == "world" && study.log != nullptr) continue;
    text += "[" + section + "]\n";
    for (const auto& [key, value] : study.settings.section(section)) {
      if (key != "until" || !value.empty()) text += key + " = " + value + "\n";
    }
    if (section == "cells") {
      for (const CellSpec& cell : study.cells) text += "cell = " + cell_line(cell) + "\n";
    }
    if (section == "world") text += inline_world_text(study.world);
  }
  return text;
}

}  // namespace montecarta::experiments
