// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/score.hpp"
#include "engine/errors.hpp"
#include "engine/records/columns.hpp"
#include "engine/wrapped_text.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/listing.hpp"
#include "experiments/external/external_filter.hpp"
#include "experiments/files/files.hpp"
#include "experiments/study/cell_spec.hpp"
#include "experiments/study/settings.hpp"
#include "experiments/text/words.hpp"
#include "experiments/worlds/world.hpp"

#include <algorithm>
#include <fstream>
#include <iostream>
#include <sstream>

namespace montecarta::experiments {
namespace {

[[noreturn]] void throw_unknown(const std::string& what, const std::string& name,
                                const std::vector<std::string>& known) {
  const std::string nearest = nearest_spelling(name, known);
  throw StudyError(name + ": not in the list of " + what + " (see montecarta list " + what +
                   "): " + (nearest.starts_with("known") ? "choose one of them" : nearest));
}

void point_to_details(const std::string& what, const std::string& example) {
  std::cout << "\n"
            << wrapped("More about one of them: montecarta list " + what + " " + example,
                       output_width());
}

/// The default, and the one for measured controls if it differs.
std::string fallback_text(const Parameter& option) {
  std::string text = option.fallback.value_or("none, it must be given");
  if (option.fallback_if_measured)
    text += ", with noise = measured-control " + *option.fallback_if_measured;
  return text;
}

TextPairs options_text(std::span<const Parameter> options) {
  TextPairs items;
  for (const Parameter& option : options) {
    items.emplace_back(option.key, option.meaning + "\n" + demand_of(option) + "; default " +
                                       fallback_text(option));
  }
  return items;
}

void list_filters() {
  TextPairs items;
  for (const FilterKind& filter : known_filters())
    items.emplace_back(filter.name, filter.long_name);
  std::cout << listing(items, 0);
  point_to_details("filters", "fastslam2");
}

void describe_filter(const std::string& name) {
  std::vector<std::string> known;
  for (const FilterKind& filter : known_filters()) known.push_back(filter.name);
  const auto found = std::ranges::find(known_filters(), name, &FilterKind::name);
  if (found == known_filters().end()) throw_unknown("filters", name, known);
  std::cout << found->name << ": " << found->long_name << "\n\n"
            << listing(
                   {{"source", found->source},
                    {"sensors", joined(found->sensors.empty() ? sensor_names() : found->sensors)}});
  if (!found->options.empty()) std::cout << "\noptions\n" << listing(options_text(found->options));
  std::cout << "\noptions of every filter\n" << listing(options_text(mismatch_options()));
}

std::string name_of(const Setting& setting) { return setting.section + "." + setting.key; }

/// The default, and the defaults for kinds of scenario that have another one.
std::string fallback_text(const Setting& setting) {
  const auto in_words = [](const std::string& value) {
    return value == kRequired       ? "none, it must be given"
           : value == kFromScenario ? "that of [scenario]"
           : value.empty()          ? "empty"
                                    : value;
  };
  std::string text;
  if (setting.fallback_of_kind.size() < 2) text = in_words(setting.fallback.value_or(kRequired));
  for (const auto& [kind, value] : setting.fallback_of_kind) {
    text += (text.empty() ? "" : "; ") + in_words(value) + " if scenario.kind = " + kind;
  }
  return text;
}

void describe(const Setting& setting) {
  const std::string first = engine::first_sentence(setting.meaning);
  std::cout << wrapped(name_of(setting) + ": " + first, output_width());
  if (first.size() < setting.meaning.size())
    std::cout << wrapped(setting.meaning.substr(first.size() + 2), output_width());
  TextPairs facts = {{"value", demand_of(setting)}, {"default", fallback_text(setting)}};
  if (!setting.unit.empty() && setting.unit != "1") facts.emplace_back("unit", setting.unit);
  if (!setting.kinds.empty())
    facts.emplace_back("only if", "scenario.kind = " + joined(setting.kinds, " or "));
  if (!setting.applies_to.empty())
    facts.emplace_back("only if", setting.section + "." + setting.chooser + " = " +
                                      joined(setting.applies_to, " or "));
  std::cout << "\n" << listing(facts);
}

/// Describes the setting with this full name, or all settings with this key, since several sections
/// may have the same key.
void describe_setting(const std::string& name) {
  std::vector<std::string> known;
  bool is_first = true;
  for (const Setting& setting : study_settings()) {
    known.insert(known.end(), {name_of(setting), setting.key});
    if (name != name_of(setting) && name != setting.key) continue;
    std::cout << (is_first ? "" : "\n");
    describe(setting);
    is_first = false;
  }
  if (is_first) throw_unknown("settings", name, known);
}

/// Title of a section in the list of settings.
std::string title_of_section(const std::string& section) {
  if (section == "study") return "how many runs";
  if (section == "scenario") return "the true world, vehicle and sensor";
  if (section == "belief")
    return "assumptions of the filters; in a simulation by default the truth";
  if (section == "association") return "association of detections with landmarks";
  return "columns to store";
}

void list_section(const std::string& section) {
  TextPairs items;
  for (const Setting& setting : study_settings()) {
    if (setting.section == section)
      items.emplace_back(setting.key, engine::first_sentence(setting.meaning));
  }
  if (items.empty()) return;
  std::cout << wrapped("[" + section + "] " + title_of_section(section), output_width())
            << listing(items);
}

void list_settings() {
  for (const std::string& section : study_sections()) list_section(section);
  point_to_details("settings", "scenario.noise");
}

std::string size_of_world(const std::string& name) {
  const World world = find_world(name);
  return std::to_string(world.landmarks.size()) + " landmarks, " +
         std::to_string(world.waypoints.size()) + " way-points";
}

void list_worlds() {
  TextPairs items;
  for (const std::string& name : shipped_worlds()) items.emplace_back(name, size_of_world(name));
  std::cout << listing(items, 0);
}

/// Path of the shipped file `name` in the folder `what`, which users may copy. Throws StudyError if
/// there is no such file.
std::string shipped_path(const std::string& what, const std::string& name,
                         const std::string& ending) {
  const auto path = shipped_file(what, name + ending);
  if (!path) throw_unknown(what, name, shipped_names(what, ending));
  return path->string();
}

void describe_world(const std::string& name) {
  const std::string path = shipped_path("worlds", name, ".csv");
  std::cout << name << ": " << size_of_world(name) << "\n\n"
            << listing({{"file", path}, {"in a study", "scenario.world = " + name}});
}

std::string title_of(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  const IniText ini = read_ini(text.str(), path.string());
  const auto found = std::ranges::find_if(
      ini.entries, [](const IniEntry& e) { return e.section == "study" && e.key == "title"; });
  return found == ini.entries.end() ? "" : found->value;
}

void list_studies() {
  TextPairs items;
  for (const std::string& name : shipped_names("studies", ".ini"))
    items.emplace_back(name, title_of(shipped_file("studies", name + ".ini").value()));
  std::cout << listing(items, 0);
  point_to_details("studies", "first_study");
}

void describe_study(const std::string& name) {
  const std::string path = shipped_path("studies", name, ".ini");
  std::cout << wrapped(name + ": " + title_of(path), output_width()) << "\n"
            << listing({{"file", path},
                        {"filters and cost", "montecarta check " + name},
                        {"run it", "montecarta run " + name}});
}

std::string in_brackets(std::string_view units) {
  return units == "1" ? "" : " [" + std::string(units) + "]";
}

void list_metrics() {
  TextPairs items;
  for (const Score& score : all_scores())
    items.emplace_back(score.name, score.words + in_brackets(score.units));
  std::cout << listing(items, 0);
  point_to_details("metrics", "position_rmse");
}

void describe_metric(const std::string& name) {
  const Score* score = find_score(name);
  if (score == nullptr) {
    std::vector<std::string> known;
    for (const Score& one : all_scores()) known.emplace_back(one.name);
    throw_unknown("metrics", name, known);
  }
  std::cout << wrapped(name + ": " + score->words, output_width()) << "\n"
            << listing({{"unit", score->units == std::string("1") ? "none" : score->units},
                        {"better", score->better == Better::lower    ? "lower"
                                   : score->better == Better::higher ? "higher"
                                                                     : "neither lower nor higher"},
                        {"used by", "montecarta compare --metric, and study.until"}});
}

/// A column of the table, or one that a filter declares itself.
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

void list_columns() {
  std::cout << wrapped(
      "The study chooses groups of columns by record.columns. The group pose is "
      "always stored.\n\n",
      output_width());
  for (const ColumnGroup& group : column_groups()) {
    TextPairs items;
    for (const ListedColumn& column : listed_columns()) {
      if (column.group == group.name) items.emplace_back(column.name, column.long_name);
    }
    std::cout << group.name << "\n" << listing(items);
  }
  point_to_details("columns", "pose_covariance");
}

void describe_column(const std::string& name) {
  const std::vector<ListedColumn> columns = listed_columns();
  const auto found = std::ranges::find(columns, name, &ListedColumn::name);
  if (found == columns.end()) {
    std::vector<std::string> known;
    for (const ListedColumn& column : columns) known.push_back(column.name);
    throw_unknown("columns", name, known);
  }
  std::cout << wrapped(name + ": " + found->long_name, output_width()) << "\n"
            << listing({{"stored if", "record.columns has " + found->group},
                        {"axes", found->axes},
                        {"unit", found->units}});
}

/// One kind of entries: how all of them are listed, and how one of them is described.
struct Listed {
  std::string name;
  void (*list)();
  void (*describe)(const std::string& name);
};

int list(const Arguments& arguments) {
  const std::vector<Listed> all = {
      {"filters", list_filters, describe_filter}, {"settings", list_settings, describe_setting},
      {"studies", list_studies, describe_study},  {"worlds", list_worlds, describe_world},
      {"metrics", list_metrics, describe_metric}, {"columns", list_columns, describe_column}};
  const std::string& what = arguments.operands().front();
  std::vector<std::string> known;
  for (const Listed& listed : all) known.push_back(listed.name);
  const auto found = std::ranges::find(all, what, &Listed::name);
  if (found == all.end()) {
    throw StudyError(what + ": nothing to list (one of " + joined(known) +
                     "): " + nearest_spelling(what, known));
  }
  if (arguments.operands().size() == 1) return found->list(), kDone;
  return found->describe(arguments.operands().back()), kDone;
}

}  // namespace

Command list_command() {
  return {{.name = "list",
           .summary = "List filters, settings, studies, worlds, metrics or columns",
           .operands = {{"WHAT"}, {"NAME", 0}},
           .options = {},
           .details = "WHAT is filters, settings, studies, worlds, metrics or columns. With NAME "
                      "that one is described in full.\n\n"
                      "examples:\n"
                      "  montecarta list filters\n"
                      "  montecarta list settings scenario.noise\n"},
          list};
}

}  // namespace montecarta::experiments
