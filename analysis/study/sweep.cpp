// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/sweep.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

namespace montecarta::analysis {
namespace {

using Settings = std::map<std::string, std::string>;

constexpr std::size_t kLeastValues = 3;  // fewer are a comparison

std::optional<double> number_of(const std::string& text) {
  double number = 0.0;
  const char* const last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, number);
  if (error != std::errc() || end != last || !std::isfinite(number)) return std::nullopt;
  return number;
}

/// The names of all settings, in the order in which the cells have them.
std::vector<std::string> setting_names(const StudyAnalysis& study) {
  std::vector<std::string> names;
  for (const CellAnalysis& cell : study.cells) {
    for (const auto& [name, value] : cell.settings) {
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

/// {cell} All settings of each cell. A setting that only other cells of its filter have is one of
/// the factors that are stored where they are not 1 (StoredCell).
std::vector<Settings> settings_of(const StudyAnalysis& study) {
  std::map<std::string, std::set<std::string>> names;
  for (const CellAnalysis& cell : study.cells) {
    for (const auto& [name, value] : cell.settings) names[cell.filter].insert(name);
  }
  std::vector<Settings> all;
  for (const CellAnalysis& cell : study.cells) {
    Settings& own = all.emplace_back(cell.settings.begin(), cell.settings.end());
    for (const std::string& name : names[cell.filter]) own.try_emplace(name, "1");
  }
  return all;
}

/// Cells that are equal but for the swept option.
struct SweptCells {
  std::string filter;
  Settings others;                              ///< the settings that they share
  std::map<double, const CellAnalysis*> cells;  ///< {value}
};

/// The cells that have this option, and have it as a number, in groups that differ in it alone.
std::vector<SweptCells> groups_of(const StudyAnalysis& study, const std::vector<Settings>& settings,
                                  const std::string& option, std::map<double, std::string>& texts) {
  std::vector<SweptCells> groups;
  for (std::size_t i = 0; i < study.cells.size(); ++i) {
    Settings others = settings[i];
    const auto own = others.extract(option);
    const auto value = own.empty() ? std::nullopt : number_of(own.mapped());
    if (!value) continue;
    const CellAnalysis& cell = study.cells[i];
    auto found = std::ranges::find_if(groups, [&](const SweptCells& group) {
      return group.filter == cell.filter && group.others == others;
    });
    if (found == groups.end())
      found = groups.insert(groups.end(), {cell.filter, std::move(others), {}});
    found->cells.try_emplace(*value, &cell);
    texts.try_emplace(*value, own.mapped());
  }
  return groups;
}

/// "de_srcd mode=shared": the filter and the settings that other groups of it have otherwise.
std::string name_of(const SweptCells& group, const std::vector<SweptCells>& groups) {
  std::string name = group.filter;
  for (const auto& setting : group.others) {
    const bool differs = std::ranges::any_of(groups, [&](const SweptCells& other) {
      return other.filter == group.filter && other.others.at(setting.first) != setting.second;
    });
    if (differs) name.append(" ").append(setting.first).append("=").append(setting.second);
  }
  return name;
}

std::optional<Sweep> sweep_of(const StudyAnalysis& study, const std::vector<Settings>& settings,
                              const std::string& option) {
  std::map<double, std::string> texts;
  std::vector<SweptCells> groups = groups_of(study, settings, option, texts);
  std::erase_if(groups, [](const SweptCells& group) { return group.cells.size() < 2; });
  const auto is_long = [](const SweptCells& group) { return group.cells.size() >= kLeastValues; };
  if (std::ranges::none_of(groups, is_long)) return std::nullopt;
  std::set<double> values;
  for (const SweptCells& group : groups) {
    for (const auto& [value, cell] : group.cells) values.insert(value);
  }
  Sweep sweep{option, {}, {}};
  for (const double value : values) sweep.values.push_back(texts.at(value));
  for (const SweptCells& group : groups) {
    SweepCurve& curve = sweep.curves.emplace_back(SweepCurve{name_of(group, groups), {}});
    for (const double value : values) {
      const auto found = group.cells.find(value);
      curve.cells.push_back(found == group.cells.end() ? nullptr : found->second);
    }
  }
  return sweep;
}

}  // namespace

std::vector<Sweep> sweeps_of(const StudyAnalysis& study) {
  const std::vector<Settings> settings = settings_of(study);
  std::vector<Sweep> sweeps;
  for (const std::string& option : setting_names(study)) {
    if (auto sweep = sweep_of(study, settings, option)) sweeps.push_back(std::move(*sweep));
  }
  return sweeps;
}

}  // namespace montecarta::analysis
