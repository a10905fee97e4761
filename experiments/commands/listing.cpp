// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/listing.hpp"

#include <algorithm>
#include <sstream>

namespace montecarta::experiments {

std::string listing(const TextPairs& items, std::size_t indent, std::size_t widest) {
  constexpr std::size_t kNarrowestText = 16;
  std::size_t longest = 0;
  for (const auto& [name, description] : items) {
    if (name.size() <= widest) longest = std::max(longest, name.size());
  }
  const std::size_t column = indent + longest + 2;
  const std::size_t width = std::max(output_width(), column + kNarrowestText);
  std::string text;
  for (const auto& [name, description] : items) {
    std::string line = std::string(indent, ' ') + name;
    if (name.size() > longest || description.empty()) {
      text += line + '\n';
      line.clear();
    }
    std::istringstream lines(wrapped(description, width - column));
    for (std::string part; std::getline(lines, part); line.clear()) {
      line.resize(column, ' ');
      text += line + part + '\n';
    }
  }
  return text;
}

}  // namespace montecarta::experiments
