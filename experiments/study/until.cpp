// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/until.hpp"

#include "analysis/comparison/cell_comparison.hpp"
#include "analysis/data/study_settings.hpp"
#include "analysis/metrics/cell_sums.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "engine/errors.hpp"
#include "engine/records/result_file.hpp"
#include "engine/runs/monte_carlo.hpp"
#include "experiments/text/words.hpp"

namespace montecarta::experiments {
namespace {

constexpr const char* kProcessorTime = "cpu_seconds";

std::vector<std::string> usable_scores() {
  std::vector<std::string> names;
  for (const Score& score : all_scores()) {
    if (score.name != std::string(kProcessorTime)) names.emplace_back(score.name);
  }
  return names;
}

const Score* score_called(const std::string& name, const std::string& place) {
  if (name == kProcessorTime) {
    throw StudyError(place + ": until = " + name +
                     " < ... (processor time differs from run to run, and results must not depend "
                     "on it): choose another metric");
  }
  if (const Score* score = find_score(name)) return score;
  throw StudyError(place + ": until = " + name + " < ... (runs have no number of that name): " +
                   nearest_spelling(name, usable_scores()));
}

bool is_verdict_known(const ResultFile& file, std::size_t cell, std::uint64_t runs,
                      const Parallel& parallel) {
  const CellAnalysis found =
      analyze_cell(file, file.cells().at(cell), Until::kLevel, runs, parallel);
  const Verdict verdict = found.consistency().verdict;
  return verdict != Verdict::undecided && verdict != Verdict::untested;
}

}  // namespace

std::optional<Until> parse_until(const std::string& text, const std::string& place) {
  if (text.empty()) return std::nullopt;
  if (trimmed(text) == kUntilVerdict) return Until{};
  const std::vector<std::string> sides = split(text, '<');
  const auto width = sides.size() == 2 ? to_number(sides[1]) : std::nullopt;
  if (!width || !(*width > 0.0)) {
    throw StudyError(place + ": until = " + text +
                     " (METRIC < HALF-WIDTH, the half-width above 0, or verdict is needed): give "
                     "e.g. until = position_rmse < 0.02, or nothing to make all runs");
  }
  return Until{score_called(sides[0], place), *width};
}

std::string text_of(const Until& until) {
  if (until.score == nullptr) return kUntilVerdict;
  return std::string(until.score->name) + " < " + to_text(until.half_width);
}

EnoughRuns rule_of(const Until& until) {
  return [until](const std::filesystem::path& unfinished, std::size_t cell, std::uint64_t runs,
                 const Parallel& parallel) {
    const ResultFile file(unfinished);
    if (until.score == nullptr) return is_verdict_known(file, cell, runs, parallel);
    const auto values = first_values(file, file.cells().at(cell), *until.score, runs, parallel);
    return is_precise(values, Until::kLevel, until.half_width);
  };
}

std::string in_words(const Until& until, std::uint64_t runs) {
  const std::string rounds = "a cell stops after " + std::to_string(kFirstRound) + ", " +
                             std::to_string(2 * kFirstRound) + ", " +
                             std::to_string(4 * kFirstRound) + ", ... runs when ";
  if (until.score == nullptr) {
    return rounds + "its verdict is known, by intervals widened for up to " +
           std::to_string(rounds_of(runs).size()) + " looks, after " + std::to_string(runs) +
           " runs in any case; failed runs are in no verdict";
  }
  const std::string unit =
      until.score->units == std::string("1") ? "" : std::string(" ") + until.score->units;
  return rounds + "the 95 % interval of its mean " + until.score->name + " is within +- " +
         to_text(until.half_width) + unit + ", after " + std::to_string(runs) +
         " runs in any case; failed runs are in no mean, and values with a heavy tail are never "
         "precise";
}

}  // namespace montecarta::experiments
