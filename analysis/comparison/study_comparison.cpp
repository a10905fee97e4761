// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/comparison/study_comparison.hpp"

#include "analysis/output/csv_file.hpp"

#include <utility>

namespace montecarta::analysis {
namespace {

constexpr const char* kComparison = "comparison.csv";
constexpr const char* kWins = "wins.csv";
constexpr const char* kPareto = "pareto.csv";

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

void write_values(const std::vector<CellValue>& values, const std::filesystem::path& path) {
  NamedRows file(path);
  for (const CellValue& value : values) {
    file.row({{"cell", value.cell}, {"verdict", value.verdict}},
             {{"cpu_seconds_mean", "s", value.cpu_seconds.mean},
              {"position_rmse_mean", "m", value.position_rmse.mean},
              {"nees_distance", "1", value.nees_distance},
              {"runs_failed", "1", count(value.failed)},
              {"on_accuracy_front", "1", value.accurate_for_cost ? 1.0 : 0.0},
              {"on_consistency_front", "1", value.consistent_for_cost ? 1.0 : 0.0}});
  }
  file.close();
}

}  // namespace

StudyComparison compare_study(const StudyAnalysis& study, const std::string& baseline,
                              std::span<const Score* const> scores) {
  StudyComparison comparison{compare_cells(study, baseline, scores), {}, cell_values(study)};
  for (const Score* score : scores) {
    WinMatrix matrix = win_matrix(study, *score);
    if (matrix.cells.size() > 1) comparison.matrices.push_back(std::move(matrix));
  }
  return comparison;
}

std::vector<std::string> comparison_csv_names() { return {kComparison, kWins, kPareto}; }

void write_comparison_csv(const StudyComparison& comparison,
                          const std::filesystem::path& directory) {
  make_directory(directory);
  write_comparisons(comparison.comparisons, directory / kComparison);
  NamedRows wins(directory / kWins);
  for (const WinMatrix& matrix : comparison.matrices) write_wins(matrix, wins);
  wins.close();
  write_values(comparison.values, directory / kPareto);
}

}  // namespace montecarta::analysis
