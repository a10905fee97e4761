// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/setting.hpp"

#include "engine/errors.hpp"
#include "engine/visible_text.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace montecarta::experiments {
namespace {

using Kind = Parameter::Kind;

std::string remedy_of(const Parameter& option) {
  const std::string value = option.fallback.value_or(option.example);
  return value.empty() ? "correct it" : "give e.g. " + option.key + " = " + value;
}

[[noreturn]] void throw_bad_value(const Parameter& option, std::string_view text,
                                  const std::string& place) {
  throw StudyError(place + ": " + option.key + " = " + std::string(text) + " (" +
                   demand_of(option) + " is needed): " + remedy_of(option));
}

std::string checked_number(const Parameter& option, std::string_view text,
                           const std::string& place) {
  const std::optional<double> value = to_number(text);
  if (!value || *value < option.least || *value > option.most) throw_bad_value(option, text, place);
  return to_text(*value + 0.0);  // no negative zero
}

std::string checked_count(const Parameter& option, std::string_view text,
                          const std::string& place) {
  const std::optional<std::uint64_t> value = to_count(text);
  const bool fits = value && static_cast<double>(*value) >= option.least &&
                    static_cast<double>(*value) <= option.most;
  if (!fits) throw_bad_value(option, text, place);
  return std::to_string(*value);
}

/// One line that a terminal shows as it is; the name of a study is part of file names.
std::string checked_text(const Parameter& option, std::string_view text, const std::string& place) {
  const std::size_t longest = option.key == "name" ? 200 : option.key == "title" ? 1000 : 1'000'000;
  if (text.size() > longest) {
    throw StudyError(place + ": " + option.key + " has " + std::to_string(text.size()) +
                     " characters (at most " + std::to_string(longest) + "): shorten it");
  }
  if (visible(text, "\t") != text) {
    throw StudyError(place + ": " + option.key + " = " + visible(text) +
                     " (a control character, or bytes that are no UTF-8): remove them");
  }
  return std::string(text);
}

void check_choice(const Parameter& option, const std::string& word, const std::string& place) {
  if (std::ranges::find(option.choices, word) != option.choices.end()) return;
  throw StudyError(place + ": " + option.key + " = " + word + " (" + demand_of(option) +
                   " is needed): " + nearest_spelling(word, option.choices));
}

/// In the order of the table, without repetition.
std::string checked_choices(const Parameter& option, std::string_view text,
                            const std::string& place) {
  const std::vector<std::string> given = split(text, ',');
  for (const std::string& word : given) check_choice(option, word, place);
  std::vector<std::string> ordered;
  for (const std::string& choice : option.choices) {
    if (std::ranges::find(given, choice) != given.end()) ordered.push_back(choice);
  }
  return joined(ordered);
}

/// A double cannot hold the largest of 64 bits, of which the reader takes every one.
std::string most_of(const Parameter& option) {
  constexpr std::uint64_t kLargest = std::numeric_limits<std::uint64_t>::max();
  const bool is_all = option.kind == Kind::count && option.most >= static_cast<double>(kLargest);
  return is_all ? std::to_string(kLargest) : to_text(option.most);
}

}  // namespace

bool Setting::is_for(std::string_view scenario_kind) const {
  return kinds.empty() || std::ranges::find(kinds, scenario_kind) != kinds.end();
}

bool Setting::is_for_choice(std::string_view choice) const {
  return chosen.empty() || std::ranges::find(chosen, choice) != chosen.end();
}

std::optional<std::string> Setting::fallback_for(std::string_view scenario_kind) const {
  for (const auto& [of_kind, value] : fallback_of_kind) {
    if (of_kind != scenario_kind) continue;
    return value == kRequired ? std::nullopt : std::optional(value);
  }
  return fallback;
}

std::string demand_of(const Parameter& option) {
  const std::string unit = option.unit.empty() || option.unit == "1" ? "" : " " + option.unit;
  const std::string range = " from " + to_text(option.least) + " to " + most_of(option) + unit;
  switch (option.kind) {
    case Kind::text:
      return "a text";
    case Kind::number:
      return "a number" + range;
    case Kind::count:
      return "a whole number" + range;
    case Kind::choice:
      return "one of " + joined(option.choices);
    case Kind::choices:
      return "a list of " + joined(option.choices);
  }
  return {};
}

std::string checked_value(const Parameter& option, std::string_view text,
                          const std::string& place) {
  switch (option.kind) {
    case Kind::text:
      if (text.empty() && !option.fallback) throw_bad_value(option, text, place);
      return checked_text(option, text, place);
    case Kind::number:
      return checked_number(option, text, place);
    case Kind::count:
      return checked_count(option, text, place);
    case Kind::choice:
      check_choice(option, std::string(text), place);
      return std::string(text);
    case Kind::choices:
      return checked_choices(option, text, place);
  }
  return {};
}

}  // namespace montecarta::experiments
