// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/setup/filter_setup.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace montecarta::experiments {

/// One `key = value` of an INI text, and where it stands.
struct IniEntry {
  std::string section;
  std::string key;
  std::string value;
  std::string place;  ///< "file:line"
};

/// A `[section]` line, and where it stands.
struct IniSection {
  std::string name;
  std::string place;
};

/// What an INI text says, in its order.
struct IniText {
  std::vector<IniSection> sections;
  std::vector<IniEntry> entries;
};

/// Reads INI: sections in brackets, `key = value`, # begins a comment. `name` stands before line
/// numbers. Throws StudyError at stray text and at entries before the first section.
IniText read_ini(const std::string& text, const std::string& name);

inline constexpr const char* kFromScenario = "scenario";
inline constexpr const char* kRequired = "(required)";
inline constexpr const char* kUsualWithin = "1.1";  ///< kUsualMargin of the analysis

/// One thing that a study file may say. The table of them drives parsing, checking, the resolved
/// text, and `montecarta list settings`.
struct Setting : Parameter {
  std::string section = {};
  /// Kinds of scenario (scenario.kind) that it says something of; empty: all.
  std::vector<std::string> kinds = {};
  /// "vehicle", "sensor" or "noise": the setting of the same section that decides whether this one
  /// says something, by its values in `applies_to`; empty: always.
  std::string chooser = {};
  /// (kind of scenario, its fallback) where that differs. kFromScenario: the scenario's value of
  /// that key; kRequired: must be given.
  std::vector<std::pair<std::string, std::string>> fallback_of_kind = {};

  bool is_for(std::string_view scenario_kind) const;
  bool is_for_choice(std::string_view choice) const;
  std::optional<std::string> fallback_for(std::string_view scenario_kind) const;
};

/// All settings but those of the filters, section by section in the order of the resolved text.
std::span<const Setting> study_settings();
/// `text` in the one spelling that the resolved study uses. Throws StudyError, beginning with
/// `place`, where the text is no value of the option.
std::string checked_value(const Parameter& option, std::string_view text, const std::string& place);

/// What a value must be: "a number from 0 to 1000 m".
std::string demand_of(const Parameter& option);

struct Setting;

/// The value of every setting of study_settings(), checked and in its one spelling.
class Settings {
 public:
  /// Fills what `entries` leave open. Sections "cells" and "world" are no concern of it.
  /// Throws StudyError at unknown and repeated keys, bad values, and where a required one is
  /// missing
  /// (`name`: of the study file).
  Settings(std::span<const IniEntry> entries, const std::string& name);

  const std::string& text(std::string_view section, std::string_view key) const;
  /// Whether a list holds `item`.
  bool lists(std::string_view section, std::string_view key, std::string_view item) const;
  double number(std::string_view section, std::string_view key) const;
  std::uint64_t count(std::string_view section, std::string_view key) const;
  /// A setting in degrees, in radians.
  double radians(std::string_view section, std::string_view key) const;
  /// "file:line" where it was given, or the file where it was not.
  const std::string& place(std::string_view section, std::string_view key) const;
  void replace(std::string_view section, std::string_view key, const std::string& value);

  /// What scenario.kind says.
  std::string scenario_kind() const;

  /// Whether there is a value: kind of scenario, vehicle and sensor have that key.
  bool has(std::string_view section, std::string_view key) const;
  /// (key, value) of a section in the order of the table, as far as the kind of scenario,
  /// vehicle and sensor have them.
  std::vector<std::pair<std::string, std::string>> section(std::string_view name) const;

 private:
  struct Value {
    std::string text;
    std::string place;
  };
  using Name = std::pair<std::string, std::string>;
  void take(const IniEntry& entry);
  void fill_in(const std::string& name);
  std::string copied_from_scenario(const Setting& setting) const;
  bool is_for_choice(const Setting& setting) const;
  const Value& at(std::string_view section, std::string_view key) const;

  std::map<Name, Value> values_;
};

/// Section names that a study file may have, in the order of the resolved text.
std::vector<std::string> study_sections();

}  // namespace montecarta::experiments
