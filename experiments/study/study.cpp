// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/study.hpp"

#include "analysis/run/study_facts.hpp"
#include "analysis/study/cell_sums.hpp"
#include "analysis/study/study_analysis.hpp"
#include "analysis/study/study_comparison.hpp"
#include "analysis/verdict/verdict.hpp"
#include "engine/errors.hpp"
#include "engine/records/result_file.hpp"
#include "engine/runs/monte_carlo.hpp"
#include "experiments/external/external_filter.hpp"
#include "experiments/files/files.hpp"
#include "experiments/study/make_drives.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>

namespace montecarta::experiments {
namespace {

constexpr const char* kProcessorTime = "cpu_seconds";

const Score* score_called(const std::string& name, const std::string& place) {
  if (name == kProcessorTime) {
    throw StudyError(place + ": until = " + name +
                     " < ... (processor time differs from run to run, and results must not depend "
                     "on it): choose another metric");
  }
  return &item_called(name, all_scores(), &Score::name,
                      place + ": until = " + name + " < ... (runs have no number of that name)");
}

/// Returns whether the verdict of a cell is known after `runs` runs: it is refused, or consistent.
/// "Consistent" needs `least_runs`, because an early stop would miss rare divergence. A file with a
/// part of the runs decides by bets alone, which need not know of the other parts.
bool is_verdict_known(const ResultFile& file, std::size_t cell, std::uint64_t runs,
                      std::uint64_t least_runs, const Parallel& parallel) {
  const CellAnalysis found =
      analyze_cell(file, file.cells().at(cell), Until::kLevel, runs, parallel);
  if (file.runs().size() < file.study_runs()) return found.verdict.refused_by_bets.has_value();
  if (found.verdict.answer == analysis::Answer::consistent) return runs >= least_runs;
  return found.verdict.is_refused;
}

/// The number in "verdict, 100 runs"; nullopt if the text is malformed.
std::optional<std::uint64_t> least_runs_in(const std::string& text) {
  const std::vector<std::string> parts = split(text, ',');
  if (parts.size() != 2 || parts[0] != kUntilVerdict || !parts[1].ends_with(" runs")) return {};
  const auto runs = to_count(parts[1].substr(0, parts[1].size() - 5));
  return runs == std::uint64_t{0} ? std::nullopt : runs;
}

/// Parses study.until; nullopt if `text` is empty, which means all runs. Throws StudyError that
/// begins with `place` if the text is malformed or the metric is no result (processor time).
std::optional<Until> parse_until(const std::string& text, const std::string& place) {
  if (text.empty()) return std::nullopt;
  if (trimmed(text) == kUntilVerdict) return Until{};
  if (const auto least_runs = least_runs_in(text)) {
    Until until;
    until.least_runs = *least_runs;
    return until;
  }
  const std::vector<std::string> sides = split(text, '<');
  const auto width = sides.size() == 2 ? to_number(sides[1]) : std::nullopt;
  if (!width || !(*width > 0.0)) {
    throw StudyError(place + ": until = " + text +
                     " (METRIC < HALF-WIDTH, the half-width above 0, or verdict is needed): give "
                     "e.g. until = position_rmse < 0.02, until = verdict, until = verdict, 100 "
                     "runs, or nothing to make all runs");
  }
  Until until;
  until.score = score_called(sides[0], place);
  until.half_width = *width;
  return until;
}

}  // namespace

std::string text_of(const Until& until) {
  if (until.score == nullptr && until.least_runs == Until::kUsualLeastRuns) return kUntilVerdict;
  if (until.score == nullptr) {
    return std::string(kUntilVerdict) + ", " + std::to_string(until.least_runs) + " runs";
  }
  return std::string(until.score->name) + " < " + to_text(until.half_width);
}

EnoughRuns rule_of(const Until& until) {
  return [until](const std::filesystem::path& unfinished, std::size_t cell, std::uint64_t runs,
                 const Parallel& parallel) {
    const ResultFile file(unfinished);
    if (until.score == nullptr) {
      return is_verdict_known(file, cell, runs, until.least_runs, parallel);
    }
    const auto values = first_values(file, file.cells().at(cell), *until.score, runs, parallel);
    return is_precise(values, Until::kLevel, until.half_width);
  };
}

std::string in_words(const Until& until, std::uint64_t runs) {
  const std::string rounds = "a cell stops after " + std::to_string(kFirstRound) + ", " +
                             std::to_string(2 * kFirstRound) + ", " +
                             std::to_string(4 * kFirstRound) + ", ... runs when ";
  if (until.score == nullptr) {
    return rounds + "its verdict is known, by intervals widened for up to " +
           std::to_string(rounds_of(runs).size()) + " interim analyses, after " +
           std::to_string(runs) + " runs in any case; failed runs do not count";
  }
  const std::string unit =
      until.score->units == std::string("1") ? "" : std::string(" ") + until.score->units;
  return rounds + "the 95 % interval of its mean " + until.score->name + " is within +- " +
         to_text(until.half_width) + unit + ", after " + std::to_string(runs) +
         " runs in any case; failed runs do not count, and values with a heavy tail are never "
         "precise";
}

namespace {

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
    item_called(
        section.name, known, std::identity(),
        section.place + ": unknown section [" + section.name + "] (it would have no effect)");
  }
}

IniEntry override_entry(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::size_t dot = text.find('.');
  if (equals == std::string::npos || dot == std::string::npos || dot > equals) {
    throw StudyError("--set " + text +
                     ": not understood (the form is section.key=value): write e.g. --set "
                     "study.runs=10, and change cells in the study file");
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
  return at_place(place + ": scenario.world = " + name, [&] { return find_world(name, {folder}); });
}

void refuse_world(const IniText& ini, const Settings& settings) {
  if (!has_inline_world(ini)) return;
  throw StudyError(settings.place("scenario", "kind") +
                   ": scenario.kind = " + settings.scenario_kind() +
                   " has its own world, and the study a [world] (it would have no effect): remove "
                   "[world]");
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
  Study study{
      settings, read_cells(ini.entries, name, known_filters(), controls_are_measured), {}, {}, {}};
  if (study.settings.scenario_kind() == "simulated") {
    study.world = world_of(ini, study.settings, folder);
    study.settings.replace("scenario", "world", study.world.name);
  } else {
    refuse_world(ini, study.settings);
    study.logs = read_drives_of(study.settings, folder);
    const bool is_given = study.settings.place("association", "kind") != name;
    if (!is_given && identities_of(study) > 0)
      study.settings.replace("association", "kind", "known");
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

/// Returns whether a setting has no effect and is left out of the resolved text, so that the
/// fingerprints of studies without it do not change.
bool is_silent(const std::string& key, const std::string& value) {
  return (key == "until" && value.empty()) || (key == "full_runs" && value == "0");
}

std::string resolved_text(const Study& study) {
  std::string text;
  for (const std::string& section : study_sections()) {
    if (section == "world" && !study.logs.empty()) continue;
    text += "[" + section + "]\n";
    for (const auto& [key, value] : study.settings.section(section)) {
      if (!is_silent(key, value)) text += key + " = " + value + "\n";
    }
    if (section == "cells") {
      for (const CellSpec& cell : study.cells) text += "cell = " + cell_line(cell) + "\n";
    }
    if (section == "world") {
      text += lines_of("waypoint", study.world.waypoints);
      text += lines_of("landmark", study.world.landmarks);
    }
  }
  return text;
}

}  // namespace montecarta::experiments
