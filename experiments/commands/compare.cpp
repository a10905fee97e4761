// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/comparison/study_comparison.hpp"
#include "analysis/data/study_settings.hpp"
#include "analysis/output/text_table.hpp"
#include "analysis/tables/tables.hpp"
#include "engine/errors.hpp"
#include "engine/wrapped_text.hpp"
#include "experiments/commands/arguments.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/output_guard.hpp"
#include "experiments/commands/stored_result.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <iostream>

namespace montecarta::experiments {
namespace {

const Score* score_called(const std::string& name) {
  if (const Score* score = find_score(name)) return score;
  std::vector<std::string> known;
  for (const Score& score : all_scores()) known.emplace_back(score.name);
  throw StudyError("--metric " + name + ": no metric (runs have no number of that name): " +
                   nearest_spelling(name, known));
}

std::vector<const Score*> scores_of(const Arguments& arguments, const ResultFile& file) {
  const auto names = arguments.text("metric");
  if (!names) return usual_scores(file.has_errors());
  std::vector<const Score*> scores;
  for (const std::string& name : split(*names, ',')) scores.push_back(score_called(name));
  return scores;
}

/// Label of the baseline cell. It is checked before the comparison starts, which takes long.
std::string baseline_of(const Arguments& arguments, const ResultFile& file) {
  std::vector<std::string> labels;
  for (const StoredCell& cell : file.cells()) labels.push_back(cell.label);
  const auto baseline = arguments.text("baseline");
  if (labels.size() == 1) {
    throw StudyError(file.path().string() + ": has one cell, " + labels.front() +
                     " (compare needs another one to compare it with): run a study of several "
                     "cells, or judge the estimates of several estimators in one file");
  }
  if (!baseline) {
    throw StudyError(
        "compare: --baseline CELL is needed (the others are compared with it): one of " +
        joined(labels));
  }
  if (std::ranges::find(labels, *baseline) != labels.end()) return *baseline;
  throw StudyError("--baseline " + *baseline + ": no cell of " + file.path().string() +
                   " (it must be one of them): " + nearest_spelling(*baseline, labels));
}

void print(const StudyAnalysis& study, const StudyComparison& comparison) {
  std::ostream& out = std::cout;
  const std::size_t width = engine::output_width();
  const double level = comparison.comparisons.level;
  print_sentences(out, study, width);
  print_table(out, comparison_table(comparison.comparisons), width);
  out << '\n';
  for (const std::string& note : comparison_notes(study, comparison.comparisons)) {
    out << engine::wrapped(note, width);
  }
  for (const WinMatrix& matrix : comparison.matrices) {
    out << '\n';
    print_table(out, win_table(matrix, level), width);
  }
  out << '\n';
  if (!comparison.matrices.empty()) out << engine::wrapped(win_note(level), width);
}

int compare(const Arguments& arguments) {
  const double level = arguments.number("level", 1e-9, 1.0 - 1e-9).value_or(0.95);
  const ResultFile file = open_stored(arguments.operands().front());
  const std::string baseline = baseline_of(arguments, file);
  const std::vector<const Score*> scores = scores_of(arguments, file);
  const auto directory = arguments.text("csv");
  if (directory && !arguments.has("force")) refuse_existing(*directory, comparison_csv_names());
  const StudyAnalysis study = analyze(file, level, parallel_of(arguments),
                                      arguments.number("within", kLeastMargin, kMostMargin));
  const StudyComparison comparison = compare_study(study, baseline, scores);
  print(study, comparison);
  if (directory) write_comparison_csv(comparison, *directory);
  return kDone;
}

}  // namespace

Command compare_command() {
  return {{.name = "compare",
           .summary = "Compare every cell with a baseline, run by run in the same worlds",
           .operands = {{"FILE.h5"}},
           .options = {{"baseline", "", {"CELL"}, "the cell that the others are compared with"},
                       {"metric", "", {"NAME,..."}, "metrics to compare (montecarta list metrics)"},
                       {"level", "", {"L"}, kLevelMeaning},
                       {"within", "", {"R"}, kWithinMeaning},
                       {"csv", "", {"DIR"}, "also write comparison.csv and wins.csv"},
                       {"force", "", {}, "replace the tables in DIR"},
                       {"threads", "", {"N"}, kThreadsMeaning},
                       {"backend", "", {"tbb|openmp|serial"}, kBackendMeaning}},
           .details = "Without --metric these are compared: position_rmse, heading_rmse, nees and "
                      "cpu_seconds.\n\nexample:\n  montecarta compare first_study.h5 --baseline "
                      "ekf_slam --metric nees\n"},
          compare};
}

}  // namespace montecarta::experiments
