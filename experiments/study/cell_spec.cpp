// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/cell_spec.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/text/list_text.hpp"
#include "experiments/study/vehicle_and_sensor.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <cctype>
#include <map>

namespace montecarta::experiments {
namespace {

/// The checked values of each option in a line.
using Lists = std::map<std::string, std::vector<std::string>>;

/// Returns the own options of a filter, followed by those that every filter has.
std::vector<Parameter> all_options(const FilterKind& filter) {
  std::vector<Parameter> all = filter.options;
  all.insert(all.end(), mismatch_options().begin(), mismatch_options().end());
  return all;
}

Parameter known_option(const FilterKind& filter, const std::string& key, const std::string& place) {
  std::vector<std::string> known{"label"};
  for (Parameter& option : all_options(filter)) {
    if (option.key == key) return std::move(option);
    known.push_back(option.key);
  }
  const std::string section = sections_with(key);
  if (!section.empty()) {
    throw StudyError("{}: {} has no option '{}' (it is no part of a cell): write it under {}",
                     place, filter.name, key, section);
  }
  throw StudyError("{}: {} has no option '{}' (nothing would come of it): {}", place, filter.name,
                   key, nearest_spelling(key, known));
}

constexpr std::size_t kLongestLabel = 200;

std::string checked_label(const std::string& label, const std::string& place) {
  const auto allowed = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; };
  const bool good = !label.empty() && std::isalpha(static_cast<unsigned char>(label[0])) != 0 &&
                    std::ranges::all_of(label, allowed);
  if (good && label.size() <= kLongestLabel) return label;
  throw StudyError(
      "{}: label = '{}' (a label is a letter, then letters, digits and _, at most {}): choose "
      "another",
      place, label, kLongestLabel);
}

/// Parses one word of a cell line behind the name of the filter.
void take_word(const std::string& word, const FilterKind& filter, CellSpec& cell, Lists& lists) {
  const std::size_t equals = word.find('=');
  if (equals == std::string::npos) {
    throw StudyError(
        "{}: stray text '{}' (a cell is FILTER key=value ..., without spaces around = and ,): "
        "write it so",
        cell.place, word);
  }
  const std::string key = word.substr(0, equals);
  if (lists.contains(key) || (key == "label" && !cell.label.empty())) {
    throw StudyError("{}: {} is given twice: remove one of the two", cell.place, key);
  }
  if (key == "label") {
    cell.label = checked_label(word.substr(equals + 1), cell.place);
    return;
  }
  const Parameter option = known_option(filter, key, cell.place);
  const std::string given = word.substr(equals + 1);
  const bool is_list = option.kind != Parameter::Kind::text;  // a text may hold commas
  for (const std::string& value : is_list ? split(given, ',') : std::vector{given}) {
    lists[key].push_back(checked_value(option, value, cell.place));
  }
}

/// Replaces every cell by one copy for each of `values` of an option.
void multiply(const std::string& key, const std::vector<std::string>& values,
              std::vector<CellSpec>& cells) {
  std::vector<CellSpec> longer;
  for (const CellSpec& cell : cells) {
    for (const std::string& value : values)
      longer.emplace_back(cell).options.emplace_back(key, value);
  }
  cells = std::move(longer);
}

/// All combinations of values, with the last option varying fastest. An option that the line omits
/// has its default.
std::vector<CellSpec> combinations(const CellSpec& line, const Lists& lists,
                                   bool controls_are_measured) {
  std::vector<CellSpec> cells{line};
  const auto values_of = [&](const Parameter& option) {
    if (const auto given = lists.find(option.key); given != lists.end()) return given->second;
    const bool has_own = controls_are_measured && option.fallback_if_measured;
    const auto& fallback = has_own ? option.fallback_if_measured : option.fallback;
    return std::vector{checked_value(option, fallback.value_or(""), line.place)};
  };
  for (const Parameter& option : all_options(*line.filter))
    multiply(option.key, values_of(option), cells);
  for (CellSpec& cell : cells) {
    const auto own = static_cast<std::ptrdiff_t>(line.filter->options.size());
    const auto rest = std::remove_if(cell.options.begin() + own, cell.options.end(),
                                     [](const auto& factor) { return factor.second == "1"; });
    cell.options.erase(rest, cell.options.end());
  }
  return cells;
}

std::vector<CellSpec> read_line(const IniEntry& entry, std::span<const FilterKind> filters,
                                bool controls_are_measured) {
  const std::vector<std::string> words =
      at_place(entry.place, [&] { return quoted_words(entry.value); });
  if (words.empty()) {
    throw StudyError("{}: cell names no filter (see montecarta list filters): write e.g. cell = {}",
                     entry.place, filters.front().name);
  }
  CellSpec line{
      .label = {},
      .filter = &item_called(words[0], filters, &FilterKind::name,
                             formatted("{}: unknown filter '{}' (see montecarta list filters)",
                                       entry.place, words[0])),
      .options = {},
      .distinction = {},
      .place = entry.place};
  Lists lists;
  for (std::size_t i = 1; i < words.size(); ++i) take_word(words[i], *line.filter, line, lists);
  std::vector<CellSpec> cells = combinations(line, lists, controls_are_measured);
  if (!line.label.empty() && cells.size() > 1) {
    throw StudyError("{}: one label for {} cells (labels are unique): remove label or the lists",
                     entry.place, cells.size());
  }
  return cells;
}

/// Returns whether a cell may differ from others of its filter in its label only, because an option
/// is a text.
bool is_known_by_label(const CellSpec& cell) {
  return std::ranges::any_of(cell.filter->options, [](const Parameter& option) {
    return option.kind == Parameter::Kind::text;
  });
}

/// Converts a value to a part of a label: 0.75 -> 0p75, -1 -> m1.
std::string label_part(std::string text) {
  for (char& c : text) {
    if (c == '-') c = 'm';
    if (c != '_' && std::isalnum(static_cast<unsigned char>(c)) == 0) c = 'p';
  }
  return text;
}

/// Returns whether cells of the same filter differ in option number `i`. Options that are texts do
/// not count, because they are no part of labels.
bool distinguishes(const std::vector<CellSpec>& cells, const CellSpec& cell, std::size_t i) {
  if (cell.filter->options[i].kind == Parameter::Kind::text) return false;
  return std::ranges::any_of(cells, [&](const CellSpec& other) {
    return other.filter == cell.filter && other.options[i].second != cell.options[i].second;
  });
}

void describe(const std::vector<CellSpec>& cells, const CellSpec& cell, std::string& label,
              std::string& distinction) {
  label = cell.filter->name;
  for (std::size_t i = 0; i < cell.options.size(); ++i) {
    const auto& [key, value] = cell.options[i];
    const bool is_mismatch = i >= cell.filter->options.size(), particles = key == "particles";
    if (!is_mismatch && !particles && !distinguishes(cells, cell, i)) continue;
    label += particles ? "_m" + value : formatted("_{}_{}", key, label_part(value));
    append_part(distinction, is_mismatch ? formatted("believes {} x {}", key, value)
                             : particles ? value + " particles"
                                         : formatted("{} {}", key, value));
  }
}

/// Gives every cell without a label one that consists of its distinguishing options.
void label_cells(std::vector<CellSpec>& cells) {
  for (CellSpec& cell : cells) {
    std::string label;
    describe(cells, cell, label, cell.distinction);
    if (cell.label.empty()) cell.label = label;
    if (cell.distinction.empty() && is_known_by_label(cell)) cell.distinction = cell.label;
  }
}

void refuse_equal_labels(const std::vector<CellSpec>& cells) {
  std::map<std::string, std::string> places;
  for (const CellSpec& cell : cells) {
    const auto [first, fresh] = places.try_emplace(cell.label, cell.place);
    if (fresh) continue;
    throw StudyError(
        "{}: cell {} is given twice (first at {}): remove it, or change a setting or its label",
        cell.place, cell.label, first->second);
  }
}

/// Returns whether the filter takes its sensors mounted elsewhere than at the pose.
bool takes_mountings(const FilterKind& kind) {
  return kind.sensors.empty() || kind.takes_mountings;
}

enum class SensorPlace { anywhere, elsewhere };

std::string filters_for(const std::string& sensor, std::span<const FilterKind> filters,
                        SensorPlace mounted = SensorPlace::anywhere) {
  std::vector<std::string> names;
  for (const FilterKind& kind : filters) {
    if (mounted == SensorPlace::elsewhere && !takes_mountings(kind)) continue;
    if (kind.sensors.empty() || std::ranges::find(kind.sensors, sensor) != kind.sensors.end())
      names.push_back(kind.name);
  }
  return joined(names);
}

void refuse_kind(const Settings& settings, const CellSpec& cell,
                 std::span<const FilterKind> filters) {
  const std::vector<std::string>& taken = cell.filter->sensors;
  const std::string& sensor = settings.text("belief", "sensor");
  if (taken.empty() || std::ranges::find(taken, sensor) != taken.end()) return;
  throw StudyError(
      "{}: {} takes no sensor {} (it takes {}): use one of {}, or another sensor in [scenario] or "
      "[belief]",
      cell.place, cell.filter->name, sensor, joined(taken), filters_for(sensor, filters));
}

void refuse_mounting(const CellSpec& cell, const Sensor& sensor,
                     std::span<const FilterKind> filters) {
  if (takes_mountings(*cell.filter) || sensor.mounting.is_none()) return;
  throw StudyError(
      "{}: {} takes no sensor that is mounted elsewhere than at the pose (mount_forward, "
      "mount_left, mount_turn_deg): set these to 0, or use one of {}",
      cell.place, cell.filter->name, filters_for(name_of(sensor), filters, SensorPlace::elsewhere));
}

void refuse_association(const Settings& settings, const CellSpec& cell, const Sensor& sensor) {
  if (settings.text("association", "kind") == "known") return;
  const bool takes_listed_sensors = !cell.filter->sensors.empty();
  if (takes_listed_sensors && !std::holds_alternative<RangeBearingSensor>(sensor.kind)) {
    throw StudyError(
        "{}: association.kind = nearest with {} ({} takes it where identities are known): set "
        "association.kind = known",
        settings.place("association", "kind"), name_of(sensor), cell.filter->name);
  }
  if (!cell.filter->delays_initialisation || fixes_landmark(sensor)) return;
  throw StudyError(
      "{}: association.kind = nearest with {} (one detection does not determine the position of a "
      "landmark, so that {} cannot associate it): set association.kind = known",
      settings.place("association", "kind"), name_of(sensor), cell.filter->name);
}

[[noreturn]] void refuse_key_among_cells(const IniEntry& entry) {
  const std::string problem = entry.place + ": unknown key cells." + entry.key;
  const std::string section = sections_with(entry.key);
  if (!section.empty())
    throw StudyError(problem + " (it belongs to another section): move it to " + section);
  throw StudyError(problem + " (a cell is cell = FILTER key=value ...): did you mean cell?");
}

}  // namespace

std::vector<CellSpec> read_cells(std::span<const IniEntry> entries, const std::string& name,
                                 std::span<const FilterKind> filters, bool controls_are_measured) {
  std::vector<CellSpec> cells;
  for (const IniEntry& entry : entries) {
    if (entry.section != "cells") continue;
    if (entry.key != "cell") refuse_key_among_cells(entry);
    for (CellSpec& cell : read_line(entry, filters, controls_are_measured))
      cells.push_back(std::move(cell));
  }
  if (cells.empty()) {
    throw StudyError(name + ": no cells (nothing to run): add [cells] with e.g. cell = ekf_slam");
  }
  label_cells(cells);
  refuse_equal_labels(cells);
  return cells;
}

void refuse_options_outside_cells(std::span<const IniEntry> entries,
                                  std::span<const FilterKind> filters) {
  for (const IniEntry& entry : entries) {
    if (entry.section == "cells" || entry.section == "world" || !sections_with(entry.key).empty())
      continue;
    const auto has_option = [&](const FilterKind& filter) {
      return std::ranges::count(all_options(filter), entry.key, &Parameter::key) > 0;
    };
    const auto filter = std::ranges::find_if(filters, has_option);
    if (filter == filters.end()) continue;
    throw StudyError(entry.place + ": unknown key " + entry.section + "." + entry.key +
                     " (it is an option of a cell): write it behind the filter under [cells], e.g. "
                     "cell = " +
                     filter->name + " " + entry.key + "=" + entry.value);
  }
}

std::string filters_that(std::span<const FilterKind> filters, bool FilterKind::*takes) {
  std::vector<std::string> names;
  for (const FilterKind& kind : filters) {
    if (kind.*takes && !kind.name.starts_with("plain_")) names.push_back(kind.name);
  }
  return joined(names);
}

std::string cell_line(const CellSpec& cell) {
  std::string line = formatted("{} label={}", cell.filter->name, cell.label);
  for (std::size_t i = 0; i < cell.options.size(); ++i) {
    const auto& [key, value] = cell.options[i];
    const std::vector<Parameter>& own = cell.filter->options;
    const bool is_text = i < own.size() && own[i].kind == Parameter::Kind::text;
    line += formatted(" {}={}", key, is_text ? in_quotes(value) : value);
  }
  return line;
}

void refuse_sensors(const Settings& settings, std::span<const CellSpec> cells,
                    std::span<const FilterKind> filters) {
  const Sensor sensor = sensor_of(settings, "belief");
  for (const CellSpec& cell : cells) {
    refuse_kind(settings, cell, filters);
    refuse_mounting(cell, sensor, filters);
    refuse_association(settings, cell, sensor);
  }
}

std::span<const Parameter> mismatch_options() {
  static const std::vector<Parameter> options = {
      number_parameter("motion_noise", "1", 1e-3, 1e3,
                       "factor on the standard deviations of the controls and of the noise of the "
                       "step that the filter assumes"),
      number_parameter(
          "sensor_noise", "1", 1e-3, 1e3,
          "factor on the standard deviations of the detections and of position fixes that the "
          "filter assumes")};
  return options;
}

double mismatch_of(const CellSpec& cell, std::string_view name) {
  for (const auto& [key, value] : cell.options) {
    if (key == name) return to_number(value).value();
  }
  return 1.0;
}

}  // namespace montecarta::experiments
