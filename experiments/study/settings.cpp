// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/settings.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/numbers/angle.hpp"
#include "engine/text/list_text.hpp"
#include "engine/text/visible_text.hpp"
#include "engine/text/wrapped_text.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <limits>
#include <sstream>

namespace montecarta::experiments {

IniText read_ini(const std::string& text, const std::string& name) {
  IniText ini;
  std::istringstream stream(text);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const std::string_view content = trimmed(std::string_view(line).substr(0, line.find('#')));
    const std::string place = formatted("{}:{}", name, number);
    if (content.empty()) continue;
    const std::size_t equals = std::min(content.find('='), content.size());
    const std::string_view key = trimmed(content.substr(0, equals));
    if (content.front() == '[' && content.back() == ']') {
      ini.sections.push_back({std::string(content.substr(1, content.size() - 2)), place});
    } else if (key.empty() || equals == content.size()) {
      throw StudyError(
          "{}: stray text '{}' (a line is [section] or key = value): complete it, or put # before "
          "it",
          place, content);
    } else if (ini.sections.empty()) {
      throw StudyError("{}: '{}' stands before any section: put [study] above it", place, content);
    } else {
      ini.entries.push_back({ini.sections.back().name, std::string(key),
                             std::string(trimmed(content.substr(equals + 1))), place});
    }
  }
  return ini;
}

namespace {

using Kind = Parameter::Kind;

std::string remedy_of(const Parameter& option) {
  const std::string value = option.fallback.value_or(option.example);
  return value.empty() ? "correct it" : formatted("give e.g. {} = {}", option.key, value);
}

[[noreturn]] void throw_bad_value(const Parameter& option, std::string_view text,
                                  const std::string& place) {
  throw StudyError("{}: {} = {} ({} is needed): {}", place, option.key, text, demand_of(option),
                   remedy_of(option));
}

std::string checked_number(const Parameter& option, std::string_view text,
                           const std::string& place) {
  const std::optional<double> value = to_number(text);
  if (!value || *value < option.least || *value > option.most) throw_bad_value(option, text, place);
  return to_text(*value + 0.0);  // the sum has no negative zero
}

std::string checked_count(const Parameter& option, std::string_view text,
                          const std::string& place) {
  const std::optional<std::uint64_t> value = to_count(text);
  const bool fits = value && static_cast<double>(*value) >= option.least &&
                    static_cast<double>(*value) <= option.most;
  if (!fits) throw_bad_value(option, text, place);
  return std::to_string(*value);
}

/// Checks a text: it must be one line that a terminal can show, and is limited in length, because
/// file names contain the name of a study.
std::string checked_text(const Parameter& option, std::string_view text, const std::string& place) {
  const std::size_t longest = option.key == "name" ? 200 : option.key == "title" ? 1000 : 1'000'000;
  if (text.size() > longest) {
    throw StudyError("{}: {} has {} characters (at most {}): shorten it", place, option.key,
                     text.size(), longest);
  }
  if (visible(text, "\t") != text) {
    throw StudyError("{}: {} = {} (a control character, or bytes that are no UTF-8): remove them",
                     place, option.key, visible(text));
  }
  return std::string(text);
}

void check_choice(const Parameter& option, const std::string& word, const std::string& place) {
  item_called(word, option.choices, std::identity(),
              formatted("{}: {} = {} ({} is needed)", place, option.key, word, demand_of(option)));
}

/// Checks a list of choices, and returns it in the order of the table without repetitions.
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

/// The largest value as a text. A double cannot represent the largest integer of 64 bits, which is
/// allowed.
std::string most_of(const Parameter& option) {
  constexpr std::uint64_t kLargest = std::numeric_limits<std::uint64_t>::max();
  const bool is_all = option.kind == Kind::count && option.most >= static_cast<double>(kLargest);
  return is_all ? std::to_string(kLargest) : to_text(option.most);
}

}  // namespace

std::string demand_of(const Parameter& option) {
  const std::string unit = option.unit.empty() || option.unit == "1" ? "" : " " + option.unit;
  const std::string range =
      formatted(" from {} to {}{}", to_text(option.least), most_of(option), unit);
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

namespace {

const Setting& known_setting(const IniEntry& entry) {
  std::vector<const Setting*> here;
  for (const Setting& setting : study_settings()) {
    if (setting.section == entry.section) here.push_back(&setting);
  }
  const auto key_of = [](const Setting* setting) { return setting->key; };
  const std::string problem =
      formatted("{}: unknown key {}.{}", entry.place, entry.section, entry.key);
  const std::string elsewhere = sections_with(entry.key);
  if (std::ranges::find(here, entry.key, key_of) == here.end() && !elsewhere.empty())
    throw StudyError("{} (it belongs to another section): move it to {}", problem, elsewhere);
  return *item_called(entry.key, here, key_of, problem + " (it would have no effect)");
}

/// Throws StudyError if the value is none of this setting, but one of the same key of another
/// section: scenario.map = known.
void refuse_value_of_other_section(const Setting& setting, const IniEntry& entry) {
  const auto has_choice = [&](const Setting& one) {
    return one.kind == Kind::choice && std::ranges::count(one.choices, entry.value) > 0;
  };
  if (setting.kind != Kind::choice || has_choice(setting)) return;
  const auto other = std::ranges::find_if(study_settings(), [&](const Setting& one) {
    return one.key == entry.key && has_choice(one);
  });
  if (other == study_settings().end()) return;
  throw StudyError("{}: {}.{} = {} ({} is needed): move it to [{}], whose {} may be {}",
                   entry.place, entry.section, entry.key, entry.value, demand_of(setting),
                   other->section, entry.key, entry.value);
}

/// The setting of that name, which must be in the table.
const Setting& setting_called(const std::string& section, const std::string& key) {
  const auto found = std::ranges::find_if(study_settings(), [&](const Setting& setting) {
    return setting.section == section && setting.key == key;
  });
  expect(found != study_settings().end(), "a condition is on a setting that does not exist");
  return *found;
}

[[noreturn]] void throw_out_of_place(const Setting& setting, const Condition& broken,
                                     const std::string& value, const std::string& place) {
  const auto in_belief = [&](const Setting& other) {
    return other.section == "belief" && other.key == setting.key;
  };
  const bool believed = broken.key == "kind" && std::ranges::any_of(study_settings(), in_belief);
  const std::string chooser = formatted("{}.{}", broken.section, broken.key);
  throw StudyError("{}: {}.{} does not apply to {} = {} (it is for {}): remove it, or {}", place,
                   setting.section, setting.key, chooser, value, joined(broken.values),
                   believed ? "give it under [belief]" : "correct " + chooser);
}

}  // namespace

Settings::Settings(std::span<const IniEntry> entries, const std::string& name) {
  for (const IniEntry& entry : entries) {
    if (entry.section != "cells" && entry.section != "world") take(entry);
  }
  fill_in(name);
}

void Settings::take(const IniEntry& entry) {
  const Setting& setting = known_setting(entry);
  refuse_value_of_other_section(setting, entry);
  const SettingValue value{checked_value(setting, entry.value, entry.place), entry.place};
  const auto [at, fresh] = values_.try_emplace({entry.section, entry.key}, value);
  if (fresh) return;
  throw StudyError("{}: {}.{} is given twice (first at {}): remove one of the two", entry.place,
                   entry.section, entry.key, at->second.place);
}

void Settings::fill_in(const std::string& name) {
  for (const Setting& setting : study_settings()) {
    const auto given = values_.find({setting.section, setting.key});
    if (const Condition* broken = broken_condition(setting)) {
      if (given == values_.end()) continue;
      throw_out_of_place(setting, *broken, text(broken->section, broken->key), given->second.place);
    }
    if (given != values_.end()) continue;
    const std::optional<std::string> fallback = fallback_of(setting);
    if (!fallback) {
      throw StudyError("{}: {}.{} is missing ({}): add {} = {} under [{}]", name, setting.section,
                       setting.key, engine::first_sentence(setting.meaning), setting.key,
                       setting.example, setting.section);
    }
    const std::string value =
        *fallback == kFromScenario ? copied_from_scenario(setting) : *fallback;
    const std::string place =
        formatted("{}: {}.{} (not given)", name, setting.section, setting.key);
    values_[{setting.section, setting.key}] = {checked_value(setting, value, place), name};
  }
}

std::string Settings::scenario_kind() const { return text("scenario", "kind"); }

/// The default of a setting; nullopt if it must be given.
std::optional<std::string> Settings::fallback_of(const Setting& setting) const {
  for (const OtherFallback& other : setting.other_fallbacks) {
    if (!has(other.section, other.key) || !lists(other.section, other.key, other.has)) continue;
    return other.value == kRequired ? std::nullopt : std::optional(other.value);
  }
  return setting.fallback;
}

/// The value of [scenario] for a setting that [belief] omits. Throws StudyError if a filter cannot
/// use the value.
std::string Settings::copied_from_scenario(const Setting& setting) const {
  if (!has("scenario", setting.key))
    return setting.fallback.value();  // the scenario has another vehicle or sensor than the belief
  const auto& [value, given_at] = at("scenario", setting.key);
  try {
    return checked_value(setting, value, given_at);
  } catch (const StudyError&) {
    throw StudyError(
        "{}: scenario.{} = {} cannot be assumed by the filters ({} is needed): give [belief] {}",
        given_at, setting.key, value, demand_of(setting), setting.key);
  }
}

const Settings::SettingValue& Settings::at(std::string_view section, std::string_view key) const {
  const auto found = values_.find({std::string(section), std::string(key)});
  expect(found != values_.end(), "a setting is asked for that the table does not have");
  return found->second;
}

/// The first condition of a setting that does not hold; nullptr if the setting applies. If it is on
/// a setting that does not apply itself, it is the condition that this one breaks.
const Condition* Settings::broken_condition(const Setting& setting) const {
  for (const Condition& condition : setting.conditions) {
    const auto& [section, key, values] = condition;
    if (values.empty()) continue;
    if (!has(section, key)) return broken_condition(setting_called(section, key));
    if (std::ranges::count(values, text(section, key)) == 0) return &condition;
  }
  return nullptr;
}

bool Settings::has(std::string_view section, std::string_view key) const {
  return values_.contains({std::string(section), std::string(key)});
}

const std::string& Settings::text(std::string_view section, std::string_view key) const {
  return at(section, key).text;
}

bool Settings::lists(std::string_view section, std::string_view key, std::string_view item) const {
  const std::vector<std::string> items = split(text(section, key), ',');
  return std::ranges::find(items, item) != items.end();
}

double Settings::number(std::string_view section, std::string_view key) const {
  return to_number(at(section, key).text).value();
}

std::uint64_t Settings::count(std::string_view section, std::string_view key) const {
  return to_count(at(section, key).text).value();
}

double Settings::radians(std::string_view section, std::string_view key) const {
  return number(section, key) / 180.0 * kPi;  // 180 is converted exactly
}

const std::string& Settings::place(std::string_view section, std::string_view key) const {
  return at(section, key).place;
}

void Settings::replace(std::string_view section, std::string_view key, const std::string& value) {
  values_.at({std::string(section), std::string(key)}).text = value;
}

std::vector<std::pair<std::string, std::string>> Settings::section(std::string_view name) const {
  std::vector<std::pair<std::string, std::string>> pairs;
  for (const Setting& setting : study_settings()) {
    if (setting.section != name || !has(name, setting.key)) continue;
    pairs.emplace_back(setting.key, text(name, setting.key));
  }
  return pairs;
}

std::vector<std::string> study_sections() {
  return {"study", "scenario", "belief", "association", "cells", "record", "world"};
}

}  // namespace montecarta::experiments
