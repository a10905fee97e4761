// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/score_table.hpp"
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/columns.hpp"
#include "engine/text/list_text.hpp"
#include "engine/text/wrapped_text.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/files/files.hpp"
#include "experiments/study/cell_spec.hpp"
#include "experiments/study/known_filters.hpp"
#include "experiments/study/settings.hpp"
#include "experiments/text/words.hpp"
#include "experiments/worlds/world.hpp"

#include <algorithm>
#include <iostream>
#include <map>

namespace montecarta::experiments {
namespace {

/// One entry of a list, with all that is printed if a user names it.
struct ListEntry {
  std::string name;
  std::string summary;    ///< text beside the name in the list
  TextPairs facts = {};   ///< lines below the summary of one entry
  std::string more = {};  ///< text above the facts
  /// Tables below the facts, with their headings.
  std::vector<std::pair<std::string, TextPairs>> tables = {};
  std::string heading = {};     ///< heading in the list, above all entries that have it
  std::string short_name = {};  ///< name in the list; empty if it is `name`
};

/// Text of the default and, if it differs, of the default for measured controls.
std::string fallback_text(const Parameter& option) {
  std::string text = option.fallback.value_or("none, it must be given");
  if (option.fallback_if_measured)
    text += ", with noise = measured-control " + *option.fallback_if_measured;
  return text;
}

TextPairs options_text(std::span<const Parameter> options) {
  TextPairs items;
  for (const Parameter& option : options) {
    items.emplace_back(option.key, formatted("{}\n{}; default {}", option.meaning,
                                             demand_of(option), fallback_text(option)));
  }
  return items;
}

std::vector<ListEntry> filters() {
  std::vector<ListEntry> entries;
  for (const FilterKind& filter : known_filters()) {
    ListEntry& entry = entries.emplace_back(ListEntry{filter.name, filter.long_name});
    entry.facts = {{"source", filter.source},
                   {"sensors", joined(filter.sensors.empty() ? sensor_names() : filter.sensors)}};
    if (!filter.options.empty()) entry.tables.emplace_back("options", options_text(filter.options));
    entry.tables.emplace_back("options of every filter", options_text(mismatch_options()));
  }
  return entries;
}

/// Text of the default, and of those that hold where another setting has some value.
std::string fallback_text(const Setting& setting) {
  const auto in_words = [](const std::string& value) {
    return value == kRequired       ? "none, it must be given"
           : value == kFromScenario ? "that of [scenario]"
           : value.empty()          ? "empty"
                                    : value;
  };
  std::string text;
  const auto kinds = std::ranges::count_if(setting.other_fallbacks, [](const OtherFallback& other) {
    return other.section == "scenario" && other.key == "kind";
  });
  if (kinds < 2) text = in_words(setting.fallback.value_or(kRequired));
  for (const auto& [section, key, has, value] : setting.other_fallbacks) {
    text += formatted("{}{} if {}.{} = {}", text.empty() ? "" : "; ", in_words(value), section, key,
                      has);
  }
  return text;
}

TextPairs facts_of(const Setting& setting) {
  TextPairs facts = {{"value", demand_of(setting)}, {"default", fallback_text(setting)}};
  if (!setting.unit.empty() && setting.unit != "1") facts.emplace_back("unit", setting.unit);
  for (const auto& [section, key, values] : setting.conditions) {
    if (!values.empty())
      facts.emplace_back("only if", formatted("{}.{} = {}", section, key, joined(values, " or ")));
  }
  return facts;
}

const std::map<std::string, std::string> kSectionTitles = {
    {"study", "how many runs"},
    {"scenario", "the true world, vehicle and sensor"},
    {"belief", "assumptions of the filters; in a simulation by default the truth"},
    {"association", "association of detections with landmarks"},
    {"record", "columns to store"}};

std::vector<ListEntry> settings() {
  std::vector<ListEntry> entries;
  for (const Setting& setting : study_settings()) {
    const std::string first = engine::first_sentence(setting.meaning);
    const std::size_t rest = std::min(first.size() + 2, setting.meaning.size());
    entries.push_back(
        {.name = formatted("{}.{}", setting.section, setting.key),
         .summary = first,
         .facts = facts_of(setting),
         .more = setting.meaning.substr(rest),
         .heading = formatted("[{}] {}", setting.section, kSectionTitles.at(setting.section)),
         .short_name = setting.key});
  }
  return entries;
}

/// Makes an entry by entry_of(name, path) for every shipped file in a folder.
template <class EntryOf>
std::vector<ListEntry> shipped_entries(const std::string& folder, const std::string& ending,
                                       const EntryOf& entry_of) {
  std::vector<ListEntry> entries;
  for (const std::string& name : shipped_names(folder, ending))
    entries.push_back(entry_of(name, shipped_file(folder, name + ending).value().string()));
  return entries;
}

ListEntry entry_of_world(const std::string& name, const std::string& path) {
  const World world = find_world(name);
  return {name,
          formatted("{} landmarks, {} way-points", world.landmarks.size(), world.waypoints.size()),
          {{"file", path}, {"in a study", "scenario.world = " + name}}};
}

ListEntry entry_of_study(const std::string& name, const std::string& path) {
  const IniText ini = read_ini(text_file(path), path);
  const auto title = std::ranges::find_if(
      ini.entries, [](const IniEntry& e) { return e.section == "study" && e.key == "title"; });
  return {name,
          title == ini.entries.end() ? "" : title->value,
          {{"file", path},
           {"filters and cost", "montecarta check " + name},
           {"run it", "montecarta run " + name}}};
}

std::vector<ListEntry> metrics() {
  std::vector<ListEntry> entries;
  for (const Score& score : all_scores()) {
    const std::string units(score.units);
    entries.push_back({score.name,
                       score.words + (units == "1" ? "" : formatted(" [{}]", units)),
                       {{"better", score.better == Better::lower    ? "lower"
                                   : score.better == Better::higher ? "higher"
                                                                    : "neither lower nor higher"},
                        {"used by", "montecarta compare --metric, and study.until"}}});
  }
  return entries;
}

/// A column of column_table(), or one that a filter declares itself.
struct ListedColumn {
  std::string name, group, axes, units, long_name;
};

std::vector<ListedColumn> listed_columns() {
  std::vector<ListedColumn> columns;
  for (const ColumnKind& kind : column_table()) {
    std::string axes = "run";
    for (const Axis axis : kind.axes) axes.append(", ").append(engine::name_of(axis));
    columns.push_back({kind.name, kind.group, axes, kind.units, kind.long_name});
  }
  for (const FilterKind& filter : known_filters()) {
    for (const OwnColumn& own : filter.reports.own_columns) {
      if (std::ranges::count(columns, own.name, &ListedColumn::name) == 0)
        columns.push_back({own.name, own.group, "run, scan", own.units, own.long_name});
    }
  }
  return columns;
}

std::vector<ListEntry> columns() {
  std::vector<ListEntry> entries;
  for (const ColumnGroup& group : column_groups()) {
    if (group.name == std::string("sums"))
      entries.push_back({.name = group.name,
                         .summary = "no column: sums over groups of runs in place of their rows",
                         .heading = group.name});
    for (const ListedColumn& column : listed_columns()) {
      if (column.group != group.name) continue;
      entries.push_back({.name = column.name,
                         .summary = column.long_name,
                         .facts = {{"stored if", "record.columns has " + column.group},
                                   {"axes", column.axes},
                                   {"unit", column.units}},
                         .heading = column.group});
    }
  }
  return entries;
}

/// A list of entries of one kind, for instance of all filters.
struct Listed {
  std::string name;
  std::vector<ListEntry> (*entries)();
  std::string example;      ///< an entry about which there is more to read
  std::string remark = {};  ///< text above the list
};

/// Prints all entries below their headings.
void list_all(const Listed& listed) {
  if (!listed.remark.empty()) std::cout << wrapped(listed.remark + "\n\n", output_width());
  const std::vector<ListEntry> entries = listed.entries();
  for (auto entry = entries.begin(); entry != entries.end();) {
    const std::string heading = entry->heading;
    TextPairs items;
    for (; entry != entries.end() && entry->heading == heading; ++entry)
      items.emplace_back(entry->short_name.empty() ? entry->name : entry->short_name,
                         entry->summary);
    if (!heading.empty()) std::cout << wrapped(heading, output_width());
    std::cout << listing(items, heading.empty() ? 0 : 2);
  }
  std::cout << wrapped(
      formatted("\nMore about one of them: montecarta list {} {}", listed.name, listed.example),
      output_width());
}

void describe(const ListEntry& entry) {
  std::cout << wrapped(formatted("{}: {}\n{}", entry.name, entry.summary, entry.more),
                       output_width())
            << "\n"
            << listing(entry.facts);
  for (const auto& [heading, items] : entry.tables)
    std::cout << "\n" << heading << "\n" << listing(items);
}

/// Describes the entry of this name, or all entries with this short name, since several sections
/// may have the same key.
void describe_all(const Listed& listed, const std::string& name) {
  std::vector<std::string> known;
  bool is_first = true;
  for (const ListEntry& entry : listed.entries()) {
    known.push_back(entry.name);
    if (!entry.short_name.empty()) known.push_back(entry.short_name);
    if (name != entry.name && name != entry.short_name) continue;
    std::cout << (is_first ? "" : "\n");
    describe(entry);
    is_first = false;
  }
  if (!is_first) return;
  const std::string nearest = nearest_spelling(name, known);
  throw StudyError("{}: not in the list of {} (see montecarta list {}): {}", name, listed.name,
                   listed.name, nearest.starts_with("known") ? "choose one of them" : nearest);
}

}  // namespace

int list_command(const Arguments& arguments) {
  const std::vector<Listed> all = {
      {"filters", filters, "fastslam2"},
      {"settings", settings, "scenario.noise"},
      {"studies", [] { return shipped_entries("studies", ".ini", entry_of_study); }, "first_study"},
      {"worlds", [] { return shipped_entries("worlds", ".csv", entry_of_world); }, "web_loop"},
      {"metrics", metrics, "position_rmse"},
      {"columns", columns, "pose_covariance",
       "The study chooses groups of columns by record.columns. The group pose is always stored."}};
  const std::string& what = arguments.operands().front();
  const Listed& listed = item_called(what, all, &Listed::name, what + ": nothing to list");
  if (arguments.operands().size() == 1) return list_all(listed), kDone;
  return describe_all(listed, arguments.operands().back()), kDone;
}

}  // namespace montecarta::experiments
