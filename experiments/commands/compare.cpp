// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/render/tables/terminal.hpp"
#include "analysis/study/study_comparison.hpp"
#include "analysis/study/text_table.hpp"
#include "analysis/verdict/verdict.hpp"
#include "engine/core/judgement.hpp"
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/text/list_text.hpp"
#include "engine/text/wrapped_text.hpp"
#include "experiments/commands/archive_comparison.hpp"
#include "experiments/commands/arguments.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/output_path.hpp"
#include "experiments/commands/stored_result.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <iostream>

namespace montecarta::experiments {
namespace {

std::vector<const Score*> scores_of(const Arguments& arguments, const ResultFile& file) {
  const auto names = arguments.text("metric");
  if (!names) return usual_scores(file.has_errors());
  std::vector<const Score*> scores;
  for (const std::string& name : split(*names, ',')) {
    scores.push_back(
        &item_called(name, all_scores(), &Score::name,
                     formatted("--metric {}: no metric (runs have no number of that name)", name)));
  }
  return scores;
}

/// Label of the baseline cell. It is checked before the comparison starts, which takes long.
std::string baseline_of(const Arguments& arguments, const ResultFile& file) {
  std::vector<std::string> labels;
  for (const StoredCell& cell : file.cells()) labels.push_back(cell.label);
  const auto baseline = arguments.text("baseline");
  if (labels.size() == 1) {
    throw StudyError(
        "{}: has one cell, {} (compare needs another one to compare it with): run a study of "
        "several cells, or judge the estimates of several estimators in one file",
        file.path(), labels.front());
  }
  if (!baseline) {
    throw StudyError(
        "compare: --baseline CELL is needed (the others are compared with it): one of " +
        joined(labels));
  }
  return item_called(
      *baseline, labels, std::identity(),
      formatted("--baseline {}: no cell of {} (it must be one of them)", *baseline, file.path()));
}

void print_notes(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) std::cout << engine::wrapped(note, engine::output_width());
}

void print_differences(const StudyAnalysis& study, const Comparisons& comparisons) {
  print_table(std::cout, difference_table(comparisons), engine::output_width());
  std::cout << '\n';
  print_notes(difference_notes(study, comparisons));
}

/// Prints the tests of each difference, and every cell against every other.
void print_tests(const StudyAnalysis& study, const StudyComparison& comparison) {
  const Comparisons& comparisons = comparison.comparisons;
  const std::size_t width = engine::output_width();
  print_table(std::cout, comparison_table(comparisons), width);
  std::cout << '\n';
  print_notes(comparison_notes(study, comparisons));
  for (const WinMatrix& matrix : comparison.matrices) {
    std::cout << '\n';
    print_table(std::cout, win_table(matrix, comparisons.level), width);
  }
  std::cout << '\n';
  if (!comparison.matrices.empty()) print_notes({win_note(comparisons.level)});
}

/// Names the scores by which no cell can be compared.
void print_absent(std::span<const Score* const> scores, const Comparisons& comparisons) {
  for (const Score* score : scores) {
    if (std::ranges::find(comparisons.rows, score, &CellComparison::score) !=
        comparisons.rows.end())
      continue;
    print_notes(
        {formatted("{}: nothing to compare ({} or all other cells have no such number): montecarta "
                   "info FILE.h5 says what is stored",
                   score->name, comparisons.baseline)});
  }
}

void print(const StudyAnalysis& study, const StudyComparison& comparison, bool with_tests) {
  const std::size_t width = engine::output_width();
  print_sentences(std::cout, study, width);
  if (comparison.comparisons.rows.empty()) return;
  for (const std::string& sentence : comparison_sentences(comparison.comparisons)) {
    std::cout << engine::wrapped(sentence, width, 2);
  }
  std::cout << '\n';
  if (with_tests) {
    print_tests(study, comparison);
  } else {
    print_differences(study, comparison.comparisons);
  }
}

}  // namespace

int compare_command(const Arguments& arguments) {
  if (arguments.has("archive")) return compare_with_archive(arguments);
  if (arguments.has("entries"))
    throw StudyError("compare: --entries without --archive (it would have no effect): add it");
  const double level = arguments.number("level", 1e-9, 1.0 - 1e-9).value_or(kUsualLevel);
  const ResultFile file = open_stored(arguments.operands().front());
  const std::string baseline = baseline_of(arguments, file);
  const std::vector<const Score*> scores = scores_of(arguments, file);
  const auto directory = arguments.text("csv");
  if (directory && !arguments.has("force")) refuse_existing(*directory, comparison_csv_names());
  const Parallel parallel = parallel_of(arguments);
  const StudyAnalysis study =
      analyze(file, level, parallel, arguments.number("within", kLeastMargin, kMostMargin));
  const StudyComparison comparison = compare_study(study, baseline, scores, parallel);
  print(study, comparison, arguments.has("all"));
  if (arguments.has("metric")) print_absent(scores, comparison.comparisons);
  if (directory) write_comparison_csv(comparison, *directory);
  return kDone;
}

}  // namespace montecarta::experiments
