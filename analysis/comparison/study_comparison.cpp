// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/comparison/study_comparison.hpp"

#include "analysis/output/csv_file.hpp"
#include "analysis/output/number_text.hpp"

#include <cmath>
#include <utility>

namespace montecarta::analysis {
namespace {

constexpr const char* kComparison = "comparison.csv";
constexpr const char* kWins = "wins.csv";

double count(std::size_t n) { return static_cast<double>(n); }

std::vector<NamedNumber> numbers_of(const CellComparison& row) {
  return {{"difference", "1", row.difference},
          {"interval_lower", "1", row.interval.lower},
          {"interval_upper", "1", row.interval.upper},
          {"heavy_tail", "1", row.has_heavy_tail ? 1.0 : 0.0},
          {"mean", "1", row.mean},
          {"baseline_mean", "1", row.baseline_mean},
          {"ratio", "1", row.ratio},
          {"runs_paired", "1", count(row.pairs)},
          {"runs_lost_by_failure", "1", count(row.without)},
          {"runs_won_by_failure", "1", count(row.baseline_without)},
          {"runs_failed_in_both", "1", count(row.neither)},
          {"runs_unpaired", "1", count(row.unpaired)},
          {"won", "1", count(row.wins.won)},
          {"lost", "1", count(row.wins.lost)},
          {"tied", "1", count(row.wins.tied)},
          {"p_sign", "1", row.wins.p},
          {"p_sign_holm", "1", row.wins.p_holm},
          {"p_rank", "1", row.rank.p},
          {"p_rank_holm", "1", row.rank_p_holm}};
}

void write_comparisons(const Comparisons& comparisons, const std::filesystem::path& path) {
  NamedRows file(path);
  for (const CellComparison& row : comparisons.rows) {
    file.row({{"metric", row.score->name},
              {"units", row.score->units},
              {"cell", row.cell},
              {"baseline", comparisons.baseline},
              {"verdict", row.verdict(comparisons.level)}},
             numbers_of(row));
  }
  file.close();
}

void write_wins(const WinMatrix& matrix, NamedRows& file) {
  for (std::size_t r = 0; r < matrix.cells.size(); ++r) {
    for (std::size_t c = 0; c < matrix.cells.size(); ++c) {
      if (r == c) continue;
      const Wins& wins = matrix.wins[r][c];
      file.row(
          {{"metric", matrix.score->name}, {"cell", matrix.cells[r]}, {"beaten", matrix.cells[c]}},
          {{"share_won", "1", wins.share()},
           {"won", "1", count(wins.won)},
           {"lost", "1", count(wins.lost)},
           {"tied", "1", count(wins.tied)},
           {"p_sign", "1", wins.p},
           {"p_sign_holm", "1", wins.p_holm}});
    }
  }
}

}  // namespace

StudyComparison compare_study(const StudyAnalysis& study, const std::string& baseline,
                              std::span<const Score* const> scores) {
  StudyComparison comparison{compare_cells(study, baseline, scores), {}};
  for (const Score* score : scores) {
    WinMatrix matrix = win_matrix(study, *score);
    if (matrix.cells.size() > 1) comparison.matrices.push_back(std::move(matrix));
  }
  return comparison;
}

std::vector<std::string> comparison_csv_names() { return {kComparison, kWins}; }

void write_comparison_csv(const StudyComparison& comparison,
                          const std::filesystem::path& directory) {
  make_directory(directory);
  write_comparisons(comparison.comparisons, directory / kComparison);
  NamedRows wins(directory / kWins);
  for (const WinMatrix& matrix : comparison.matrices) write_wins(matrix, wins);
  wins.close();
}

namespace {

/// How many runs the difference is of, and what became of the others.
std::string pairs_text(const CellComparison& row) {
  std::string text = std::to_string(row.pairs);
  const auto add = [&](std::size_t n, const char* words) {
    if (n > 0) text.append(", ").append(std::to_string(n)).append(words);
  };
  add(row.without, " lost by failure");
  add(row.baseline_without, " won by failure");
  add(row.neither, " failed in both");
  add(row.unpaired, " unpaired");
  return text;
}

std::vector<std::string> row_of(const CellComparison& row, double level) {
  return {heading(row.score->name, row.score->units),
          row.cell,
          row.verdict(level),
          readable(row.difference),
          row.has_heavy_tail ? "heavy tail" : interval_text(row.interval),
          readable(row.ratio),
          percent(row.wins.share()),
          readable(row.wins.p_holm, 2),
          readable(row.rank_p_holm, 2),
          pairs_text(row)};
}

/// "40 of 200 runs" of failures in words; nothing where there are none.
void note_failures(const StudyAnalysis& study, std::vector<std::string>& notes) {
  for (const CellAnalysis& cell : study.cells) {
    if (cell.failures.empty()) continue;
    notes.push_back(cell.label + " FAILED in " + std::to_string(cell.failures.size()) +
                    " runs: each counts as lost in its win shares and sign tests, and is left out "
                    "of differences, ratios and signed-rank tests, which look at the " +
                    std::to_string(cell.complete) + " complete runs alone.");
  }
}

}  // namespace

TextTable comparison_table(const Comparisons& comparisons) {
  TextTable table;
  table.headings = {{"what", Align::left},
                    {"cell", Align::left},
                    {"verdict", Align::left},
                    {"difference"},
                    {level_text(comparisons.level) + " interval"},
                    {"ratio"},
                    {"runs won"},
                    {"p sign"},
                    {"p rank"},
                    {"runs", Align::left}};
  for (const CellComparison& row : comparisons.rows) {
    table.rows.push_back(row_of(row, comparisons.level));
  }
  return table;
}

TextTable win_table(const WinMatrix& matrix, double level) {
  TextTable table;
  table.headings = {{std::string(matrix.score->name) + ": row beats", Align::left}};
  for (const std::string& cell : matrix.cells) table.headings.push_back({cell});
  for (std::size_t r = 0; r < matrix.cells.size(); ++r) {
    std::vector<std::string> row = {matrix.cells[r]};
    for (std::size_t c = 0; c < matrix.cells.size(); ++c) {
      const Wins& wins = matrix.wins[r][c];
      row.push_back(percent(wins.share()) + (wins.p_holm < 1.0 - level ? " *" : ""));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::vector<std::string> comparison_notes(const StudyAnalysis& study,
                                          const Comparisons& comparisons) {
  const std::string level = level_text(comparisons.level);
  std::vector<std::string> notes = {
      "Each cell against " + comparisons.baseline +
          ", run by run in the same world with the same noise: 'difference' is the mean of what "
          "the cell has more than " +
          comparisons.baseline +
          ", with the interval in which it would lie over infinitely many "
          "runs with probability " +
          level +
          " (bootstrap over runs), 'ratio' the quotient of the "
          "means, 'runs won' how often the cell was the better one: the lower one, of a "
          "number that is not better high or low.",
      "'better' and 'worse' are said where chance alone would hardly show it: where the runs won "
      "and lost are more uneven than a fair coin's ('p sign', exact sign test), or the differences "
      "lean to one side ('p rank', Wilcoxon's signed-rank test). Both p are adjusted for all " +
          std::to_string(2 * comparisons.rows.size()) +
          " tests of the table (Holm): the probability of one false word in all of it is at most " +
          level_text(1.0 - comparisons.level) +
          ". Both look at runs, not at the mean: where the interval of the mean difference holds 0 "
          "the word is 'in most runs', and 'mixed' where it lies on the other side. 'heavy tail' "
          "stands where a few runs decide the mean difference, so that no interval can be given."};
  note_failures(study, notes);
  return notes;
}

std::string win_note(double level) {
  return "Share of runs in which the cell of the row beats the one of the column, in the same "
         "world "
         "with the same noise; a run that failed in one cell is won by the other. With * one of "
         "the "
         "two wins more often than chance would have it (exact sign test at " +
         level_text(1.0 - level) + " for the whole matrix, by Holm's correction).";
}

}  // namespace montecarta::analysis
