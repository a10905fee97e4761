// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/stopping_rule.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "experiments/text/words.hpp"

#include <vector>

namespace montecarta::experiments {
namespace {

/// The number in "verdict, 100 runs"; nullopt if the text is malformed.
std::optional<std::uint64_t> least_runs_in(const std::string& text) {
  const std::vector<std::string> parts = split(text, ',');
  if (parts.size() != 2 || parts[0] != kUntilVerdict || !parts[1].ends_with(" runs")) return {};
  const auto runs = to_count(parts[1].substr(0, parts[1].size() - 5));
  return runs == std::uint64_t{0} ? std::nullopt : runs;
}

}  // namespace

std::optional<StoppingRule> parse_stopping_rule(const std::string& text, const std::string& place) {
  if (text.empty()) return std::nullopt;
  if (trimmed(text) == kUntilVerdict) return StoppingRule{};
  if (const auto least_runs = least_runs_in(text)) return StoppingRule{.least_runs = *least_runs};
  const std::vector<std::string> sides = split(text, '<');
  const auto width = sides.size() == 2 ? to_number(sides[1]) : std::nullopt;
  if (!width || !(*width > 0.0)) {
    throw StudyError(
        "{}: until = {} (METRIC < HALF-WIDTH, the half-width above 0, or verdict is needed): give "
        "e.g. until = position_rmse < 0.02, until = verdict, until = verdict, 100 runs, or nothing "
        "to make all runs",
        place, text);
  }
  return StoppingRule{.metric = sides[0], .half_width = *width};
}

std::string text_of(const StoppingRule& rule) {
  if (rule.metric) return formatted("{} < {}", *rule.metric, to_text(rule.half_width));
  if (rule.least_runs == StoppingRule::kUsualLeastRuns) return kUntilVerdict;
  return formatted("{}, {} runs", kUntilVerdict, rule.least_runs);
}

}  // namespace montecarta::experiments
