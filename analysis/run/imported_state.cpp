// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/imported_state.hpp"

#include <algorithm>
#include <cstddef>
#include <set>
#include <utility>

namespace montecarta::analysis {
namespace {

std::vector<std::string> words_in(const std::string& list) {
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(", ", begin), list.size());
    words.push_back(list.substr(begin, end - begin));
    begin = end + 2;
  }
  return words;
}

}  // namespace

std::string setting_of(const TextPairs& settings, const char* name) {
  const auto pair = std::ranges::find(settings, name, &TextPairs::value_type::first);
  return pair == settings.end() ? std::string() : pair->second;
}

bool has_bounds(const TextPairs& settings) {
  return !setting_of(settings, "pair").empty() || setting_of(settings, "increments") == "bounded" ||
         setting_of(settings, "anchored") == "bounded";
}

const char* ImportedState::name_of_ratio() const {
  return are_innovations() ? "NIS ratio" : "NEES ratio";
}

std::string ImportedState::name_of_whole() const {
  if (are_innovations()) return "innovation";
  if (!pair.empty()) return "difference";
  if (!windows.empty()) return "increment";
  return state == "vector" ? "state" : "pose";
}

ImportedState imported_state(const StoredCell& cell) {
  ImportedState found;
  const auto setting = [&](const char* name) { return setting_of(cell.settings, name); };
  if (setting("state") == kInnovationsAlone) found.state = kInnovationsAlone;
  if (!cell.has("error")) {
    if (found.is_imported()) found.components = found.units = {};
    return found;
  }
  found.state = setting("state");
  found.convention = setting("error");
  found.windows = setting("windows");
  found.moved = setting("moved");
  found.adds_truth_covariance = setting("truth_covariance") == "added";
  found.pair = setting("pair");
  found.components = words_in(setting("components"));
  found.units = words_in(setting("units"));
  return found;
}

std::vector<StateBlock> blocks_of(std::span<const std::string> components,
                                  std::span<const std::string> units) {
  struct BlockKind {
    const char* name;
    const char* unit;
    std::vector<std::string> components;
  };
  static const std::vector<BlockKind> kKinds = {{"position", "m", {"x", "y", "z"}},
                                                {"rotation", "rad", {"rx", "ry", "rz"}},
                                                {"heading", "rad", {"heading"}},
                                                {"velocity", "mps", {"vx", "vy", "vz"}}};
  std::vector<StateBlock> blocks;
  for (const BlockKind& kind : kKinds) {
    StateBlock block{kind.name, {}};
    for (std::size_t k = 0; k < std::min(components.size(), units.size()); ++k) {
      if (units[k] == kind.unit && std::ranges::count(kind.components, components[k]) > 0)
        block.components.push_back(static_cast<Eigen::Index>(k));
    }
    const std::size_t size = block.components.size();
    if (size > 0 && size < components.size()) blocks.push_back(std::move(block));
  }
  return blocks;
}

std::size_t sensors_of(const ResultFile& file) {
  std::set<std::string> sensors;
  for (const StoredCell& cell : file.cells()) sensors.insert(setting_of(cell.settings, "sensor"));
  sensors.erase("");
  return std::max<std::size_t>(sensors.size(), 1);
}

}  // namespace montecarta::analysis
