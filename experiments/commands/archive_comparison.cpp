// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/archive_comparison.hpp"

#include "analysis/study/study_analysis.hpp"
#include "analysis/study/study_comparison.hpp"
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/text/wrapped_text.hpp"
#include "experiments/benchmark/archive_entry.hpp"
#include "experiments/benchmark/benchmark_study.hpp"
#include "experiments/benchmark/matrix.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/stored_result.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

constexpr const char* kArchiveNote =
    "Filters are compared run by run, on the same drives with the same noise. 'difference' is the "
    "mean of the archived filter minus that of yours, with its 95 % interval; 'ratio' is the "
    "quotient of the means; 'runs won' is the share of runs in which the archived filter is "
    "better. A difference has no interval if few runs decide the mean ('heavy tail').";

void refuse_options_of_cells(const Arguments& arguments) {
  for (const char* option : {"baseline", "metric", "all", "csv", "level", "within"}) {
    if (!arguments.has(option)) continue;
    throw StudyError(
        "compare: --{} with --archive (entries have three scores and a verdict at 95 %): remove "
        "one of them",
        option);
  }
}

/// The entries of the world of a result. Throws StudyError if there is none.
std::vector<ArchiveEntry> entries_of_world(const ResultFile& file, const Arguments& arguments) {
  const auto named = arguments.text("entries");
  std::vector<ArchiveEntry> entries = read_entries(named ? fs::path(*named) : shipped_archive());
  const std::string drives = drives_sha256(file.study_text());
  std::erase_if(entries, [&](const ArchiveEntry& entry) { return entry.drives_sha256 != drives; });
  if (!entries.empty()) return entries;
  throw StudyError(
      "{}: no archived filter ran in its world (world, noise, belief and seed must be those of the "
      "benchmark): make it with 'montecarta benchmark FOLDER --cell ...'; its worlds are {}",
      file.path(), joined(benchmark_worlds()));
}

/// An archived filter as the comparison needs it.
CellAnalysis cell_of(const ArchiveEntry& entry) {
  CellAnalysis cell;
  cell.label = entry.label;
  for (std::uint64_t run = 0; run < entry.runs; ++run) {
    if (std::isnan(entry.scores[kArchivedPositionRmse][run])) {
      cell.failures.push_back({run, 0, {}});
      continue;
    }
    cell.runs.push_back(run);
    std::vector<ScoreTable::Value> values;
    for (std::size_t k = 0; k < kArchivedScores.size(); ++k)
      values.push_back({kArchivedScores.at(k), entry.scores[k][run]});
    cell.scores.add(values);
  }
  cell.complete = cell.runs.size();
  cell.nees.emplace_back().series.dimension = 3;  // of a pose
  return cell;
}

/// Gives the archived scores of a cell the precision of the archive, so that equal runs are equal.
void round_scores(CellAnalysis& cell) {
  for (const char* name : kArchivedScores) {
    std::vector<double> values = cell.scores.column(name);
    std::ranges::transform(values, values.begin(), archived);
    cell.scores.put(name, std::move(values));
  }
}

/// A cell of a result as a row of the table, beside the archive.
ArchiveEntry row_of(const CellAnalysis& cell, const ArchiveEntry& of_world, std::uint64_t runs) {
  ArchiveEntry row;
  row.world = of_world.world;
  row.label = cell.label + " (yours)";
  row.cell = of_world.cell;
  row.drives_sha256 = of_world.drives_sha256;
  row.runs = runs;
  row.failed = cell.failures.size();
  row.verdict = verdict_in_short(cell.verdict);
  row.cpu_seconds = cell.over_runs("cpu_seconds").mean;
  row.scores = scores_of_runs(cell, runs);
  return row;
}

void print_differences_from(const StudyAnalysis& study, const std::string& mine,
                            const Parallel& parallel) {
  std::vector<const Score*> scores;
  for (const char* name : kArchivedScores) scores.push_back(find_score(name));
  const Comparisons comparisons = compare_cells(study, mine, scores, parallel);
  std::cout << '\n'
            << wrapped(formatted("Archived filters against yours, {}:", mine), output_width());
  print_table(std::cout, difference_table(comparisons), output_width());
  const std::string pairs = analysis::pairs_of_all_rows(comparisons);
  if (!pairs.empty()) std::cout << "\nRuns in each comparison: " << pairs << ".\n";
}

}  // namespace

int compare_with_archive(const Arguments& arguments) {
  refuse_options_of_cells(arguments);
  const ResultFile file = open_stored(arguments.operands().front());
  std::vector<ArchiveEntry> entries = entries_of_world(file, arguments);
  const Parallel parallel = parallel_of(arguments);
  StudyAnalysis mine = analyze(file, kUsualLevel, parallel);
  StudyAnalysis both = mine;
  both.cells.clear();
  for (const ArchiveEntry& entry : entries) both.cells.push_back(cell_of(entry));
  const std::uint64_t runs = file.runs().front() + mine.runs_here;
  const ArchiveEntry of_world = entries.front();
  for (CellAnalysis& cell : mine.cells) {
    round_scores(cell);
    entries.push_back(row_of(cell, of_world, runs));
  }
  print_table(std::cout, world_table(matrix_of(entries), 0), output_width());
  for (const CellAnalysis& cell : mine.cells) {
    both.cells.insert(both.cells.begin(), cell);
    print_differences_from(both, cell.label, parallel);
    both.cells.erase(both.cells.begin());
  }
  std::cout << '\n' << wrapped(kArchiveNote, output_width());
  return kDone;
}

}  // namespace montecarta::experiments
