// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/data/study_setting.hpp"

#include <sstream>

namespace montecarta::analysis {

std::optional<std::string> study_setting(const std::string& study_text, std::string_view key) {
  const std::string beginning = std::string(key) + " = ";
  std::istringstream lines(study_text);
  bool inside = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('[')) inside = line == "[study]";
    if (inside && line.starts_with(beginning)) return line.substr(beginning.size());
  }
  return std::nullopt;
}

}  // namespace montecarta::analysis
