// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/study_facts.hpp"

#include "analysis/statistics/spread.hpp"
#include "engine/errors.hpp"
#include "engine/runs/monte_carlo.hpp"

#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>
#include <string_view>

namespace montecarta::analysis {
namespace {

/// The value of `key` in the section [study]; nullopt if it is not given.
std::optional<std::string> setting_in(const std::string& study_text, std::string_view key) {
  const std::string beginning = std::string(key) + " = ";
  std::istringstream lines(study_text);
  bool inside = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('[')) inside = line == "[study]";
    if (inside && line.starts_with(beginning)) return line.substr(beginning.size());
  }
  return std::nullopt;
}

/// The number in `text`; NaN if it is none.
double number_in(const std::string& text) {
  double number = 0.0;
  const char* const last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, number);
  return error == std::errc() && end == last ? number : kNaN;
}

double margin_from(const std::string& text) {
  const double margin = number_in(text);
  if (margin >= kLeastMargin && margin <= kMostMargin) return margin;
  throw StudyError("study.within = {} (a ratio from 1.001 to 100 is needed): choose another file",
                   text);
}

double time_from(const std::string& text) {
  const double time = number_in(text);
  if (std::isfinite(time)) return time;
  throw StudyError("study.judge_from = {} (a time in seconds is needed): choose another file",
                   text);
}

}  // namespace

StudyFacts study_facts_in(const std::string& study_text, std::uint64_t runs) {
  StudyFacts facts;
  if (const auto within = setting_in(study_text, "within")) facts.within = margin_from(*within);
  if (const auto from = setting_in(study_text, "judge_from")) facts.judge_from = time_from(*from);
  const std::string until = setting_in(study_text, "until").value_or("");
  facts.stops_early = !until.empty();
  const std::string with_runs = std::string(kUntilVerdict) + ", ";  // "verdict, 100 runs"
  if (until == kUntilVerdict || until.starts_with(with_runs)) {
    facts.runs_at_analyses = rounds_of(runs);
  }
  return facts;
}

StudyFacts study_facts_of(const ResultFile& file) {
  try {
    return study_facts_in(file.study_text(), file.study_runs());
  } catch (const StudyError& error) {
    throw StudyError("{} (the study in it): {}", file.path(), error.what());
  }
}

}  // namespace montecarta::analysis
