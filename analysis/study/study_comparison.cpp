// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/study_comparison.hpp"

#include "analysis/statistics/bootstrap.hpp"
#include "analysis/statistics/interval.hpp"
#include "analysis/study/cell_analysis.hpp"
#include "analysis/study/frame.hpp"
#include "analysis/study/nees_result.hpp"
#include "analysis/study/paired_runs.hpp"
#include "analysis/study/prose.hpp"
#include "analysis/study/registry.hpp"
#include "analysis/study/score_table.hpp"
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/text/number_text.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace montecarta::analysis {
namespace {

/// Counts wins. A failed run is lost, unless neither direction of the score is better.
Wins wins_of(const PairedRuns& pairs, const Score& score) {
  Wins wins;
  if (score.better != Better::neither) wins = {pairs.left_alone, pairs.right_alone, pairs.neither};
  for (std::size_t i = 0; i < pairs.left.size(); ++i) {
    const double left = pairs.left[i], right = pairs.right[i];
    const double behind = are_equal(left, right) ? 0.0 : disadvantage(score, left, right);
    ++(behind < 0.0 ? wins.won : behind > 0.0 ? wins.lost : wins.tied);
  }
  wins.p = wins.p_holm = sign_test(wins.won, wins.lost);
  return wins;
}

/// The block whose NEES a score is; nullopt for other scores.
std::optional<ErrorBlock> judged_block(const Score& score) {
  const std::string_view name = score.name;
  if (name == "nees") return ErrorBlock::pose;
  if (name == "nees_position") return ErrorBlock::position;
  if (name == "nees_heading") return ErrorBlock::heading;
  return std::nullopt;
}

/// Name of a score in tables, which show a NEES as its ratio to the expected one.
std::string name_in_tables(const Score& score) {
  const auto block = judged_block(score);
  if (!block) return score.name;
  return *block == ErrorBlock::pose ? "NEES ratio" : name_of(*block) + " NEES ratio";
}

double expectation_of(const Score& score, const CellAnalysis& cell) {
  const auto block = judged_block(score);
  const NeesResult* nees = block ? cell.find_nees(*block, cell.leading) : nullptr;
  return nees == nullptr ? 1.0 : static_cast<double>(nees->series.dimension);
}

CellComparison compare_pair(const CellAnalysis& cell, const CellAnalysis& baseline,
                            const Score& score, double level) {
  const PairedRuns pairs = paired_runs(cell, baseline, score);
  const std::vector<double> differences = pairs.differences();
  CellComparison row{.cell = cell.label, .score = &score};
  row.pairs = pairs.left.size();
  row.without = pairs.right_alone;
  row.baseline_without = pairs.left_alone;
  row.neither = pairs.neither;
  row.unpaired = pairs.unpaired;
  row.mean = spread_of(pairs.left).summary.mean;
  row.baseline_mean = spread_of(pairs.right).summary.mean;
  row.difference = spread_of(differences).summary.mean;
  row.interval = bootstrap_mean(differences, level);
  row.has_heavy_tail = is_heavy_tailed(differences);
  if (score.has_ratio) row.ratio = row.mean / row.baseline_mean;
  row.expectation = expectation_of(score, cell);
  row.wins = wins_of(pairs, score);
  row.rank = signed_rank_test(differences);
  return row;
}

/// Adjusts the p-values: both tests of all rows are one family.
void adjust(std::vector<CellComparison>& rows) {
  std::vector<double> p;
  for (const CellComparison& row : rows) p.insert(p.end(), {row.wins.p, row.rank.p});
  const std::vector<double> adjusted = holm(p);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].wins.p_holm = adjusted[2 * i];
    rows[i].rank_p_holm = adjusted[2 * i + 1];
  }
}

const CellAnalysis& cell_called(const StudyAnalysis& study, const std::string& label) {
  const auto found = std::ranges::find(study.cells, label, &CellAnalysis::label);
  if (found != study.cells.end()) return *found;
  throw StudyError("{}: no cell of {} (each is compared with one of its own): choose another",
                   label, study.file);
}

Wins seen_from_the_other(Wins wins) {
  std::swap(wins.won, wins.lost);
  return wins;
}

/// Adjusts the p-values: each pair of cells is one test, from either side.
void adjust(WinMatrix& matrix) {
  const std::size_t n = matrix.cells.size();
  std::vector<double> p;
  for (std::size_t r = 0; r < n; ++r) {
    for (std::size_t c = r + 1; c < n; ++c) p.push_back(matrix.wins[r][c].p);
  }
  const std::vector<double> adjusted = holm(p);
  auto next = adjusted.begin();
  for (std::size_t r = 0; r < n; ++r) {
    for (std::size_t c = r + 1; c < n; ++c) {
      matrix.wins[r][c].p_holm = matrix.wins[c][r].p_holm = *next++;
    }
  }
}

constexpr const char* kComparison = "comparison.csv";
constexpr const char* kWins = "wins.csv";

double count(std::size_t n) { return static_cast<double>(n); }

Frame::Row numbers_of(const CellComparison& row) {
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

Frame comparisons_frame(const Comparisons& comparisons) {
  Frame frame;
  for (const CellComparison& row : comparisons.rows) {
    frame.add({{"metric", row.score->name},
               {"units", row.score->units},
               {"cell", row.cell},
               {"baseline", comparisons.baseline},
               {"verdict", row.verdict(comparisons.level)}},
              numbers_of(row));
  }
  return frame;
}

void add_wins(const WinMatrix& matrix, Frame& frame) {
  for (std::size_t r = 0; r < matrix.cells.size(); ++r) {
    for (std::size_t c = 0; c < matrix.cells.size(); ++c) {
      if (r == c) continue;
      const Wins& wins = matrix.wins[r][c];
      frame.add({{"metric", matrix.score->name},
                 {"cell", matrix.cells[r]},
                 {"beaten", matrix.cells[c]},
                 {"share_won", "1", wins.share()},
                 {"won", "1", count(wins.won)},
                 {"lost", "1", count(wins.lost)},
                 {"tied", "1", count(wins.tied)},
                 {"p_sign", "1", wins.p},
                 {"p_sign_holm", "1", wins.p_holm}});
    }
  }
}

/// Number of paired runs, and the reasons why others are not paired.
std::string pairs_text(const CellComparison& row) {
  std::string text = std::to_string(row.pairs);
  const auto add = [&](std::size_t n, const char* words) {
    if (n > 0) text.append(", ").append(std::to_string(n)).append(words);
  };
  const bool is_directed = row.score->better != Better::neither;
  add(row.without, is_directed ? " lost by failure" : " failed");
  add(row.baseline_without, is_directed ? " won by failure" : " failed in the baseline");
  add(row.neither, " failed in both");
  add(row.unpaired, " unpaired");
  return text;
}

/// A finding in words: "NEES ratio higher (277 times as large)".
std::string finding_of(const CellComparison& row, double level) {
  const std::string finding = name_in_tables(*row.score) + ' ' + row.verdict(level);
  return std::isfinite(row.ratio)
             ? formatted("{} ({} times as large)", finding, readable(row.ratio))
             : finding;
}

/// A sentence on one cell, to which all rows belong: "fast against ekf: NEES ratio higher (277
/// times as large); undecided: position_rmse."
std::string sentence_of(std::span<const CellComparison> rows, const Comparisons& all) {
  std::string decided, undecided;
  for (const CellComparison& row : rows) {
    const bool is_decided = row.verdict(all.level) != "undecided";
    std::string& list = is_decided ? decided : undecided;
    if (!list.empty()) list += ", ";
    list += is_decided ? finding_of(row, all.level) : name_in_tables(*row.score);
  }
  if (!undecided.empty())
    undecided = (decided.empty() ? "undecided: " : "; undecided: ") + undecided;
  const std::string& cell = rows.front().cell;
  const bool is_turned = all.seen_from == SeenFrom::baseline;
  return formatted("{} against {}: {}{}.", is_turned ? all.baseline : cell,
                   is_turned ? cell : all.baseline, decided, undecided);
}

/// Adds, for each cell with failures, a note on how they count.
void add_failures(const StudyAnalysis& study, std::vector<std::string>& notes) {
  for (const CellAnalysis& cell : study.cells) {
    if (cell.failures.empty()) continue;
    notes.push_back(prose("comparison", "failures",
                          {{"cell", cell.label},
                           {"failed", std::to_string(cell.failures.size())},
                           {"complete", std::to_string(cell.complete)}}));
  }
}

/// The interval of the difference that tables show.
Interval shown_interval(const CellComparison& row) {
  return {row.interval.lower / row.expectation, row.interval.upper / row.expectation};
}

std::vector<TextTable::Entry> row_of(const CellComparison& row, double level) {
  return {{"what", heading(name_in_tables(*row.score), row.score->units), Align::left},
          {"cell", row.cell, Align::left},
          {"verdict", row.verdict(level), Align::left},
          {"difference", readable(row.difference / row.expectation)},
          {level_text(level) + " interval",
           row.has_heavy_tail ? "heavy tail" : interval_text(shown_interval(row))},
          {"ratio", readable(row.ratio)},
          {"runs won", percent(row.wins.share())},
          {"p sign", readable(row.wins.p_holm, 2)},
          {"p rank", readable(row.rank_p_holm, 2)},
          {"runs", pairs_text(row), Align::left}};
}

}  // namespace

double Wins::share() const {
  const auto all = static_cast<double>(won + lost + tied);
  return static_cast<double>(won) / all;
}

std::string CellComparison::verdict(double level) const {
  const double significant = 1.0 - level;
  int ahead = 0, behind = 0;
  if (wins.p_holm < significant) ++(wins.won > wins.lost ? ahead : behind);
  if (rank_p_holm < significant) {
    const double towards = disadvantage(*score, rank.positive, rank.negative);
    ++(towards < 0.0 ? ahead : behind);
  }
  if ((ahead > 0) == (behind > 0)) return "undecided";
  const bool directed = score->better != Better::neither;
  std::string word = directed ? (ahead > 0 ? "better" : "worse") : (ahead > 0 ? "lower" : "higher");
  if (std::isnan(interval.lower)) return word;
  const double side = ahead > 0 ? 1.0 : -1.0;
  const double one = side * disadvantage(*score, interval.lower, 0.0);
  const double other = side * disadvantage(*score, interval.upper, 0.0);
  if (!has_heavy_tail && one > 0.0 && other > 0.0) return "mixed";
  if (!has_heavy_tail && one < 0.0 && other < 0.0) return word;
  const std::size_t agreeing = ahead > 0 ? wins.won : wins.lost;
  return word + (agreeing == pairs && without + baseline_without + neither + unpaired == 0
                     ? " in all runs"
                     : " in most runs");
}

double disadvantage(const Score& score, double left, double right) {
  return score.better == Better::higher ? right - left : left - right;
}

Wins wins_of(const CellAnalysis& left, const CellAnalysis& right, const Score& score) {
  return wins_of(paired_runs(left, right, score), score);
}

Comparisons compare_cells(const StudyAnalysis& study, const std::string& baseline,
                          std::span<const Score* const> scores, const Parallel& parallel) {
  const CellAnalysis& base = cell_called(study, baseline);
  std::vector<std::pair<const CellAnalysis*, const Score*>> pairs;
  for (const Score* score : scores) {
    for (const CellAnalysis& cell : study.cells) {
      if (&cell == &base || !is_judged_by(cell, *score) || !is_judged_by(base, *score)) continue;
      pairs.emplace_back(&cell, score);
    }
  }
  Comparisons comparisons{baseline, study.level, std::vector<CellComparison>(pairs.size()),
                          SeenFrom::cell};
  parallel.for_each(pairs.size(), [&](std::size_t i) {
    comparisons.rows[i] = compare_pair(*pairs[i].first, base, *pairs[i].second, study.level);
  });
  std::erase_if(comparisons.rows, [](const CellComparison& row) {
    return row.pairs + row.without + row.baseline_without == 0;
  });
  adjust(comparisons.rows);
  return comparisons;
}

Comparisons seen_from_baseline(Comparisons comparisons) {
  comparisons.seen_from = SeenFrom::baseline;
  for (CellComparison& row : comparisons.rows) {
    std::swap(row.without, row.baseline_without);
    std::swap(row.mean, row.baseline_mean);
    row.difference = 0.0 - row.difference;  // 0 remains without a sign
    row.interval = {0.0 - row.interval.upper, 0.0 - row.interval.lower};
    if (row.score->has_ratio) row.ratio = row.mean / row.baseline_mean;
    row.wins = seen_from_the_other(row.wins);
    std::swap(row.rank.positive, row.rank.negative);
  }
  return comparisons;
}

std::vector<const Score*> usual_scores(bool has_truth) {
  const std::vector<std::string> names =
      has_truth ? std::vector<std::string>{"position_rmse", "heading_rmse", "nees", "cpu_seconds"}
                : std::vector<std::string>{"reference_rms", "reference_aligned_rms", "cpu_seconds"};
  std::vector<const Score*> scores;
  for (const std::string& name : names) scores.push_back(find_score(name));
  return scores;
}

WinMatrix win_matrix(const StudyAnalysis& study, const Score& score) {
  WinMatrix matrix{&score, {}, {}};
  std::vector<const CellAnalysis*> cells;
  for (const CellAnalysis& cell : study.cells) {
    if (!is_judged_by(cell, score)) continue;
    cells.push_back(&cell);
    matrix.cells.push_back(cell.label);
  }
  matrix.wins.assign(cells.size(), std::vector<Wins>(cells.size()));
  for (std::size_t r = 0; r < cells.size(); ++r) {
    for (std::size_t c = r + 1; c < cells.size(); ++c) {
      matrix.wins[r][c] = wins_of(*cells[r], *cells[c], score);
      matrix.wins[c][r] = seen_from_the_other(matrix.wins[r][c]);
    }
  }
  adjust(matrix);
  return matrix;
}

StudyComparison compare_study(const StudyAnalysis& study, const std::string& baseline,
                              std::span<const Score* const> scores, const Parallel& parallel) {
  StudyComparison comparison{compare_cells(study, baseline, scores, parallel), {}};
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
  write_csv(comparisons_frame(comparison.comparisons), directory / kComparison);
  Frame wins;
  for (const WinMatrix& matrix : comparison.matrices) add_wins(matrix, wins);
  write_csv(wins, directory / kWins);
}

std::vector<std::string> comparison_sentences(const Comparisons& comparisons) {
  // The loop sorts the rows by cell. The cells keep the order that they have in the first score.
  std::vector<CellComparison> rows = comparisons.rows;
  std::vector<std::string> sentences;
  for (auto first = rows.begin(); first != rows.end();) {
    const auto next = std::stable_partition(
        first, rows.end(), [cell = first->cell](const auto& row) { return row.cell == cell; });
    sentences.push_back(sentence_of({first, next}, comparisons));
    first = next;
  }
  return sentences;
}

std::string pairs_of_all_rows(const Comparisons& comparisons) {
  if (comparisons.rows.empty()) return "";
  const std::string first = pairs_text(comparisons.rows.front());
  const bool are_alike = std::ranges::all_of(
      comparisons.rows, [&](const CellComparison& row) { return pairs_text(row) == first; });
  return are_alike ? first : "";
}

TextTable difference_table(const Comparisons& comparisons) {
  TextTable table{.keys = 2};
  const bool is_turned = comparisons.seen_from == SeenFrom::baseline;
  const std::string& own = comparisons.baseline;
  const std::string heading_of_difference = formatted(
      "{} [{}]", is_turned ? own + " minus that" : "difference", level_text(comparisons.level));
  const bool have_own_pairs = pairs_of_all_rows(comparisons).empty();
  for (const CellComparison& row : comparisons.rows) {
    const double difference = row.difference / row.expectation;
    std::vector<TextTable::Entry> entries = {
        {"what", heading(name_in_tables(*row.score), row.score->units), Align::left},
        {is_turned ? "against" : "cell", row.cell, Align::left},
        {heading_of_difference, row.has_heavy_tail
                                    ? readable(difference) + " (heavy tail)"
                                    : with_interval(difference, shown_interval(row))},
        {"ratio", readable(row.ratio)},
        {is_turned ? formatted("runs {} won", own) : "runs won", percent(row.wins.share())}};
    if (have_own_pairs) entries.push_back({"runs", pairs_text(row), Align::left});
    table.add(entries);
  }
  return table;
}

TextTable comparison_table(const Comparisons& comparisons) {
  TextTable table{.keys = 2};
  for (const CellComparison& row : comparisons.rows) table.add(row_of(row, comparisons.level));
  return table;
}

TextTable win_table(const WinMatrix& matrix, double level) {
  TextTable table;
  table.headings = {{name_in_tables(*matrix.score) + ": row beats", Align::left}};
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

std::vector<std::string> difference_notes(const StudyAnalysis& study,
                                          const Comparisons& comparisons) {
  std::vector<std::string> notes =
      paragraphs("comparison", "differences",
                 {{"baseline", comparisons.baseline}, {"level", level_text(comparisons.level)}});
  const std::string pairs = pairs_of_all_rows(comparisons);
  if (!pairs.empty()) notes.push_back(prose("comparison", "pairs", {{"pairs", pairs}}));
  add_failures(study, notes);
  return notes;
}

std::vector<std::string> comparison_notes(const StudyAnalysis& study,
                                          const Comparisons& comparisons) {
  std::vector<std::string> notes =
      paragraphs("comparison", "notes",
                 {{"baseline", comparisons.baseline},
                  {"level", level_text(comparisons.level)},
                  {"tests", std::to_string(2 * comparisons.rows.size())},
                  {"error", level_text(1.0 - comparisons.level)}});
  add_failures(study, notes);
  return notes;
}

std::string win_note(double level) {
  return prose("comparison", "wins", {{"error", level_text(1.0 - level)}});
}

}  // namespace montecarta::analysis
