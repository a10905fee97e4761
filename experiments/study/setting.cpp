// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/setting.hpp"

#include "engine/errors.hpp"
#include "experiments/text/numbers.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace montecarta {
namespace {

using Kind = Setting::Kind;

std::string remedy_of(const Setting& setting) {
  const std::string value = setting.fallback.value_or(setting.example);
  return value.empty() ? "correct it" : "give e.g. " + setting.key + " = " + value;
}

[[noreturn]] void throw_bad_value(const Setting& setting, std::string_view text,
                                  const std::string& place) {
  throw StudyError(place + ": " + setting.key + " = " + std::string(text) + " (" +
                   demand_of(setting) + " is needed): " + remedy_of(setting));
}

std::string checked_number(const Setting& setting, std::string_view text,
                           const std::string& place) {
  const std::optional<double> value = to_number(text);
  if (!value || *value < setting.least || *value > setting.most)
    throw_bad_value(setting, text, place);
  return to_text(*value + 0.0);  // no negative zero
}

std::string checked_count(const Setting& setting, std::string_view text, const std::string& place) {
  const std::optional<std::uint64_t> value = to_count(text);
  const bool fits = value && static_cast<double>(*value) >= setting.least &&
                    static_cast<double>(*value) <= setting.most;
  if (!fits) throw_bad_value(setting, text, place);
  return std::to_string(*value);
}

void check_choice(const Setting& setting, const std::string& word, const std::string& place) {
  if (std::ranges::find(setting.choices, word) != setting.choices.end()) return;
  throw StudyError(place + ": " + setting.key + " = " + word + " (" + demand_of(setting) +
                   " is needed): " + nearest_spelling(word, setting.choices));
}

/// In the order of the table, without repetition.
std::string checked_choices(const Setting& setting, std::string_view text,
                            const std::string& place) {
  const std::vector<std::string> given = split(text, ',');
  for (const std::string& word : given) check_choice(setting, word, place);
  std::vector<std::string> ordered;
  for (const std::string& choice : setting.choices) {
    if (std::ranges::find(given, choice) != given.end()) ordered.push_back(choice);
  }
  return joined(ordered);
}

/// A double cannot hold the largest of 64 bits, of which the reader takes every one.
std::string most_of(const Setting& setting) {
  constexpr std::uint64_t kLargest = std::numeric_limits<std::uint64_t>::max();
  const bool is_all = setting.kind == Kind::count && setting.most >= static_cast<double>(kLargest);
  return is_all ? std::to_string(kLargest) : to_text(setting.most);
}

}  // namespace

bool Setting::is_for(std::string_view scenario_kind) const {
  return kinds.empty() || std::ranges::find(kinds, scenario_kind) != kinds.end();
}

std::optional<std::string> Setting::fallback_for(std::string_view scenario_kind) const {
  for (const auto& [of_kind, value] : fallback_of_kind) {
    if (of_kind != scenario_kind) continue;
    return value == kRequired ? std::nullopt : std::optional(value);
  }
  return fallback;
}

const std::vector<std::string>& recorded_kinds() {
  static const std::vector<std::string> kinds = {"victoria_park", "car_park", "log"};
  return kinds;
}

std::string demand_of(const Setting& setting) {
  const std::string unit = setting.unit.empty() || setting.unit == "1" ? "" : " " + setting.unit;
  const std::string range = " from " + to_text(setting.least) + " to " + most_of(setting) + unit;
  switch (setting.kind) {
    case Kind::text:
      return "a text";
    case Kind::number:
      return "a number" + range;
    case Kind::count:
      return "a whole number" + range;
    case Kind::choice:
      return "one of " + joined(setting.choices);
    case Kind::choices:
      return "a list of " + joined(setting.choices);
  }
  return {};
}

std::string checked_value(const Setting& setting, std::string_view text, const std::string& place) {
  switch (setting.kind) {
    case Kind::text:
      if (text.empty() && !setting.fallback) throw_bad_value(setting, text, place);
      return std::string(text);
    case Kind::number:
      return checked_number(setting, text, place);
    case Kind::count:
      return checked_count(setting, text, place);
    case Kind::choice:
      check_choice(setting, std::string(text), place);
      return std::string(text);
    case Kind::choices:
      return checked_choices(setting, text, place);
  }
  return {};
}

}  // namespace montecarta
