// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/imported_state.hpp"

#include <algorithm>
#include <cstddef>

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

ImportedState imported_state(const StoredCell& cell) {
  ImportedState found;
  const auto setting = [&](const char* name) {
    const auto pair = std::ranges::find(cell.settings, name, &TextPairs::value_type::first);
    return pair == cell.settings.end() ? std::string() : pair->second;
  };
  if (setting("state") == kInnovationsAlone) found.state = kInnovationsAlone;
  found.gate = setting("gate");
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

}  // namespace montecarta::analysis
