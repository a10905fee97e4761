// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/study/setting_table.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace montecarta::experiments {

/// One `key = value` of an INI text, with its place.
struct IniEntry {
  std::string section;
  std::string key;
  std::string value;
  std::string place;  ///< place in the text: "file:line"
};

/// A `[section]` line, with its place.
struct IniSection {
  std::string name;
  std::string place;
};

/// The contents of an INI text, in its order.
struct IniText {
  std::vector<IniSection> sections;
  std::vector<IniEntry> entries;
};

/// Parses an INI text: sections in brackets, `key = value`, # begins a comment. Places are `name`
/// and a line number. Throws StudyError for stray text and for entries before the first section.
IniText read_ini(const std::string& text, const std::string& name);

/// Returns `text` in the canonical spelling of the resolved study. Throws StudyError that begins
/// with `place` if the text is not a valid value of the option.
std::string checked_value(const Parameter& option, std::string_view text, const std::string& place);

/// The values that an option allows, e.g. "a number from 0 to 1000 m".
std::string demand_of(const Parameter& option);

/// The values of all settings of study_settings(), checked and in canonical spelling.
class Settings {
 public:
  /// Takes the values from `entries` and fills in defaults. Ignores the sections "cells" and
  /// "world". Throws StudyError for unknown and repeated keys, bad values, and missing values;
  /// `name` is that of the study file.
  Settings(std::span<const IniEntry> entries, const std::string& name);

  const std::string& text(std::string_view section, std::string_view key) const;
  /// Returns whether a list holds `item`.
  bool lists(std::string_view section, std::string_view key, std::string_view item) const;
  double number(std::string_view section, std::string_view key) const;
  std::uint64_t count(std::string_view section, std::string_view key) const;
  /// A setting in degrees, converted to radians.
  double radians(std::string_view section, std::string_view key) const;
  /// "file:line" of the setting, or the file if it has a default.
  const std::string& place(std::string_view section, std::string_view key) const;
  void replace(std::string_view section, std::string_view key, const std::string& value);

  /// The value of scenario.kind.
  std::string scenario_kind() const;

  /// Returns whether the setting applies to the kind of scenario, vehicle and sensor, and so has a
  /// value.
  bool has(std::string_view section, std::string_view key) const;
  /// Pairs (key, value) of the settings of a section that have a value, in the order of the table.
  std::vector<std::pair<std::string, std::string>> section(std::string_view name) const;

 private:
  struct SettingValue {
    std::string text;
    std::string place;
  };
  using Name = std::pair<std::string, std::string>;
  void take(const IniEntry& entry);
  void fill_in(const std::string& name);
  std::optional<std::string> fallback_of(const Setting& setting) const;
  std::string copied_from_scenario(const Setting& setting) const;
  const Condition* broken_condition(const Setting& setting) const;
  const SettingValue& at(std::string_view section, std::string_view key) const;

  std::map<Name, SettingValue> values_;
};

/// Section names that a study file may have, in the order of the resolved text.
std::vector<std::string> study_sections();

}  // namespace montecarta::experiments
