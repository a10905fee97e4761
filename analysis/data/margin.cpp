// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/data/margin.hpp"

#include "engine/errors.hpp"

#include <charconv>
#include <sstream>

namespace montecarta::analysis {

double margin_in(const std::string& study_text) {
  constexpr std::string_view kKey = "within = ";
  std::istringstream lines(study_text);
  bool inside = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('[')) inside = line == "[study]";
    if (!inside || !line.starts_with(kKey)) continue;
    double margin = 0.0;
    const char* const last = line.data() + line.size();
    const auto [end, error] = std::from_chars(line.data() + kKey.size(), last, margin);
    const bool is_good = error == std::errc() && end == last && margin >= kLeastMargin;
    if (is_good && margin <= kMostMargin) return margin;
    throw StudyError("study." + line +
                     " (a ratio from 1.001 to 100 is needed): choose another file");
  }
  return kUsualMargin;
}

}  // namespace montecarta::analysis
