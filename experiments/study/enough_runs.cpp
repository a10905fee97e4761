// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/enough_runs.hpp"

#include "analysis/study/cell_sums.hpp"
#include "analysis/study/study_analysis.hpp"
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/result_file.hpp"
#include "engine/runs/monte_carlo.hpp"
#include "engine/text/number_text.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <filesystem>

namespace montecarta::experiments {
namespace {

constexpr const char* kProcessorTime = "cpu_seconds";

const Score& score_called(const std::string& name, const std::string& place) {
  if (name == kProcessorTime) {
    throw StudyError(
        "{}: until = {} < ... (processor time differs from run to run, and results must not depend "
        "on it): choose another metric",
        place, name);
  }
  return item_called(
      name, all_scores(), &Score::name,
      formatted("{}: until = {} < ... (runs have no number of that name)", place, name));
}

/// Returns whether the verdict of a cell is known after `runs` runs: it is refused, or consistent.
/// "Consistent" needs `least_runs`, because an early stop would miss rare divergence. A file with a
/// part of the runs decides by bets alone, which need not know of the other parts.
bool is_verdict_known(const ResultFile& file, std::size_t cell, std::uint64_t runs,
                      std::uint64_t least_runs, const Parallel& parallel) {
  const CellAnalysis found =
      analyze_cell(file, file.cells().at(cell), StoppingRule::kLevel, runs, parallel);
  if (file.runs().size() < file.study_runs()) return found.verdict.refused_by_bets.has_value();
  if (found.verdict.answer == analysis::Answer::consistent) return runs >= least_runs;
  return found.verdict.is_refused;
}

}  // namespace

EnoughRuns enough_runs(const StoppingRule& rule, const std::string& place) {
  const Score* const score = rule.metric ? &score_called(*rule.metric, place) : nullptr;
  return [rule, score](const std::filesystem::path& unfinished, std::size_t cell,
                       std::uint64_t runs, const Parallel& parallel) {
    const ResultFile file(unfinished);
    if (score == nullptr) return is_verdict_known(file, cell, runs, rule.least_runs, parallel);
    const auto values = first_values(file, file.cells().at(cell), *score, runs, parallel);
    return is_precise(values, StoppingRule::kLevel, rule.half_width);
  };
}

std::string in_words(const StoppingRule& rule, std::uint64_t runs) {
  const std::string rounds = formatted("a cell stops after {}, {}, {}, ... runs when ", kFirstRound,
                                       2 * kFirstRound, 4 * kFirstRound);
  if (!rule.metric) {
    return formatted(
        "{}its verdict is known, by intervals widened for up to {} interim analyses, "
        "\"consistent\" after {} runs at the earliest, after {} runs in any case; failed runs do "
        "not count",
        rounds, rounds_of(runs).size(), std::min(rule.least_runs, runs), runs);
  }
  const std::string units = score_called(*rule.metric, "study.until").units;
  return formatted(
      "{}the {} interval of its mean {} is within +- {}{}, after {} runs in any case; failed runs "
      "do not count, and values with a heavy tail are never precise",
      rounds, level_text(StoppingRule::kLevel), *rule.metric, to_text(rule.half_width),
      units == "1" ? "" : " " + units, runs);
}

}  // namespace montecarta::experiments
