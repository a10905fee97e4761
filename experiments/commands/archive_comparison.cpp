// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/archive_comparison.hpp"

#include "analysis/statistics/run_mean.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/study/prose.hpp"
#include "analysis/study/study_analysis.hpp"
#include "analysis/study/study_comparison.hpp"
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/text/list_text.hpp"
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
    "Filters are compared run by run, on the same drives with the same noise. The difference is "
    "the mean of yours minus that of the archived filter, with its 95 % interval. The ratio is the "
    "mean of yours divided by that of the archived filter. Yours wins the runs in which its number "
    "is lower; a lower NEES ratio is not always better. If few runs decide the mean, the "
    "difference has no interval ('heavy tail').";

constexpr std::size_t kErrorsOfAPose = 3;  ///< components that a NEES of the archive judges

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

/// An entry with the scores of runs [first, last) alone, and its NEES ratio and failures over them.
/// Verdict and processor time remain those of all its runs.
ArchiveEntry over_runs(ArchiveEntry entry, std::uint64_t first, std::uint64_t last) {
  last = std::min(last, entry.runs);
  if (first == 0 && last == entry.runs) return entry;
  std::vector<double> ratios;
  entry.failed = 0;
  for (std::vector<double>& scores : entry.scores) {
    for (std::uint64_t run = 0; run < entry.runs; ++run) {
      if (run < first || run >= last) scores[run] = kNaN;
    }
  }
  for (std::uint64_t run = first; run < last; ++run) {
    if (std::isnan(entry.scores[kArchivedPositionRmse][run])) ++entry.failed;
    const double nees = entry.scores[kArchivedNees][run];
    if (!std::isnan(nees)) ratios.push_back(nees / static_cast<double>(kErrorsOfAPose));
  }
  entry.runs = last - std::min(first, last);
  const auto mean = RunMean::of_ratio(spread_of(ratios).summary);
  entry.verdict.ratio = mean.mean();
  entry.verdict.interval = mean.interval(entry.verdict.level);
  return entry;
}

/// Runs [first, last) of an archived filter as the comparison needs them.
CellAnalysis cell_of(const ArchiveEntry& entry, std::uint64_t first, std::uint64_t last) {
  CellAnalysis cell;
  cell.label = entry.label;
  for (std::uint64_t run = first; run < std::min(last, entry.runs); ++run) {
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
  cell.nees.emplace_back().series.dimension = kErrorsOfAPose;
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

/// A cell of a result, whose runs end before `end`, as a row of the table beside the archive.
ArchiveEntry row_of(const CellAnalysis& cell, const ArchiveEntry& of_world, std::uint64_t end) {
  ArchiveEntry row;
  row.world = of_world.world;
  row.label = cell.label + " (yours)";
  row.cell = of_world.cell;
  row.drives_sha256 = of_world.drives_sha256;
  row.failed = cell.failures.size();
  row.verdict = verdict_in_short(cell.verdict);
  row.cpu_seconds = cpu_seconds_of(cell);
  row.scores = scores_of_runs(cell, end);
  return row;
}

/// Compares a cell with every archived filter, of which `archived` has the cells.
Comparisons comparisons_of(const CellAnalysis& cell, StudyAnalysis archived,
                           const Parallel& parallel) {
  archived.cells.insert(archived.cells.begin(), cell);
  std::vector<const Score*> scores;
  for (const char* name : kArchivedScores) scores.push_back(find_score(name));
  return seen_from_baseline(compare_cells(archived, cell.label, scores, parallel));
}

void print_differences(const Comparisons& comparisons) {
  std::cout << '\n'
            << wrapped(formatted("Yours, {}, against the archived filters:", comparisons.baseline),
                       output_width());
  print_table(std::cout, difference_table(comparisons), output_width());
  const std::string pairs = analysis::pairs_of_all_rows(comparisons);
  if (pairs.empty()) return;
  std::cout << '\n'
            << wrapped(analysis::prose("comparison", "pairs", {{"pairs", pairs}}), output_width());
}

/// Says over which runs the numbers of archived filters are, if these are not all of theirs.
std::string note_on_shown_runs(const std::vector<ArchiveEntry>& all,
                               const std::vector<ArchiveEntry>& shown) {
  for (std::size_t i = 0; i < shown.size(); ++i) {
    if (shown[i].runs == all[i].runs) continue;
    return formatted(
        "Archived filters are shown over the {} runs that yours has too, but for verdicts and "
        "CPU/run, which are over all of theirs.",
        shown[i].runs);
  }
  return "";
}

/// Prints the cells of `mine` in one table with the entries of their world.
void print_world(const StudyAnalysis& mine, const std::vector<ArchiveEntry>& entries,
                 std::uint64_t first_run) {
  const std::uint64_t end = first_run + mine.runs_here;
  std::vector<ArchiveEntry> rows;
  for (const ArchiveEntry& entry : entries) rows.push_back(over_runs(entry, first_run, end));
  const std::string note = note_on_shown_runs(entries, rows);
  for (const CellAnalysis& cell : mine.cells) {
    rows.push_back(row_of(cell, entries.front(), end));
    rows.back().runs = mine.runs_here;
  }
  print_table(std::cout, world_table(matrix_of(rows), 0), output_width());
  if (!note.empty()) std::cout << '\n' << wrapped(note, output_width());
}

}  // namespace

int compare_with_archive(const Arguments& arguments) {
  refuse_options_of_cells(arguments);
  const ResultFile file = open_stored(arguments.operands().front());
  const std::vector<ArchiveEntry> entries = entries_of_world(file, arguments);
  const Parallel parallel = parallel_of(arguments);
  StudyAnalysis mine = analyze(file, kUsualLevel, parallel);
  StudyAnalysis archived = mine;
  archived.cells.clear();
  const std::uint64_t first_run = file.runs().front();
  for (const ArchiveEntry& entry : entries)
    archived.cells.push_back(cell_of(entry, first_run, first_run + mine.runs_here));
  std::vector<Comparisons> all;
  for (CellAnalysis& cell : mine.cells) {
    round_scores(cell);
    all.push_back(comparisons_of(cell, archived, parallel));
  }
  for (const Comparisons& comparisons : all) {
    for (const std::string& sentence : comparison_sentences(comparisons))
      std::cout << wrapped(sentence, output_width(), 2);
  }
  std::cout << '\n';
  print_world(mine, entries, first_run);
  for (const Comparisons& comparisons : all) print_differences(comparisons);
  std::cout << '\n' << wrapped(kArchiveNote, output_width());
  return kDone;
}

}  // namespace montecarta::experiments
