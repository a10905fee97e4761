// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/setup/filter_options.hpp"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace montecarta::experiments {

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
  /// says something, by its values in `chosen`; empty: always.
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

}  // namespace montecarta::experiments
