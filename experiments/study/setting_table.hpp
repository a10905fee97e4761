// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"
#include "filters/models/parameter.hpp"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace montecarta::experiments {

inline constexpr const char* kFromScenario = "scenario";
inline constexpr const char* kRequired = "(required)";
/// The condition that another setting has one of `values`, or any value if `values` is empty.
struct Condition {
  std::string section, key;
  std::vector<std::string> values;
};

/// A default that holds where another setting, which comes earlier in the table, has a value, or
/// lists it.
struct OtherFallback {
  std::string section, key, has;  ///< the other setting, and its value
  std::string value;              ///< default; kRequired for none, kFromScenario for the scenario's
};

/// One setting of a study file. The table of settings is used for parsing, checking, the resolved
/// text, and `montecarta list settings`.
struct Setting : Parameter {
  std::string section = {};
  /// Conditions that must all hold for the setting to apply: on scenario.kind, then on the vehicle,
  /// the sensor or the noise of its section. The settings that they name come earlier in the table.
  std::vector<Condition> conditions = {};
  /// Defaults in place of `fallback`: the first one that holds.
  std::vector<OtherFallback> other_fallbacks = {};
};

/// All settings but those of the filters, section by section in the order of the resolved text.
std::span<const Setting> study_settings();

/// The sections that have a setting of this name: "[scenario] or [belief]"; empty if none has.
std::string sections_with(std::string_view key);

}  // namespace montecarta::experiments
