// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/factory.hpp"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace montecarta {

inline constexpr const char* kFromScenario = "scenario";
inline constexpr const char* kRequired = "(required)";

/// One thing that a study file may say. The table of them drives parsing, checking, the resolved
/// text, and `montecarta list settings`.
struct Setting {
  enum class Kind {
    text,     ///< anything
    number,   ///< finite, from `least` to `most`
    count,    ///< whole, from `least` to `most`
    choice,   ///< one of `choices`
    choices,  ///< a list out of `choices`
  };
  std::string section = {};
  std::string key = {};
  Kind kind = Kind::text;
  std::string unit = {};                     ///< "" where there is none
  std::optional<std::string> fallback = {};  ///< nullopt: must be given
  double least = 0.0;
  double most = 0.0;
  std::vector<std::string> choices = {};
  std::string meaning = {};  ///< one line
  std::string example = {};  ///< offered as remedy where there is no fallback
  /// Kinds of scenario (scenario.kind) that it says something of; empty: all.
  std::vector<std::string> kinds = {};
  /// (kind of scenario, its fallback) where that differs. kFromScenario: the scenario's value of
  /// that key; kRequired: must be given.
  std::vector<std::pair<std::string, std::string>> fallback_of_kind = {};

  bool is_for(std::string_view scenario_kind) const;
  std::optional<std::string> fallback_for(std::string_view scenario_kind) const;
};

/// Kinds of scenario whose drive was recorded.
const std::vector<std::string>& recorded_kinds();

/// All settings but those of the filters, section by section in the order of the resolved text.
std::span<const Setting> study_settings();
/// The setting that a filter's option is, in a cell line.
Setting setting_of(const FilterOption& option);

/// `text` in the one spelling that the resolved study uses. Throws StudyError, beginning with
/// `place`, where the text is no value of the setting.
std::string checked_value(const Setting& setting, std::string_view text, const std::string& place);

/// What a value must be: "a number from 0 to 1000 m".
std::string demand_of(const Setting& setting);

}  // namespace montecarta
