// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/study_facts.hpp"

#include "engine/errors.hpp"
#include "engine/runs/monte_carlo.hpp"

#include <charconv>
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

double margin_in(const std::string& study_text) {
  const auto text = study_setting(study_text, "within");
  if (!text) return kUsualMargin;
  double margin = 0.0;
  const char* const last = text->data() + text->size();
  const auto [end, error] = std::from_chars(text->data(), last, margin);
  const bool is_good = error == std::errc() && end == last && margin >= kLeastMargin;
  if (is_good && margin <= kMostMargin) return margin;
  throw StudyError("study.within = " + *text +
                   " (a ratio from 1.001 to 100 is needed): choose another file");
}

std::vector<std::uint64_t> interim_analyses_in(const std::string& study_text, std::uint64_t runs) {
  const std::string until = study_setting(study_text, "until").value_or("");
  const std::string with_runs = std::string(kUntilVerdict) + ", ";  // "verdict, 100 runs"
  if (until != kUntilVerdict && !until.starts_with(with_runs)) return {};
  return rounds_of(runs);
}

}  // namespace montecarta::analysis
