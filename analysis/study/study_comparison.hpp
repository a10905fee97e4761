// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/interval.hpp"
#include "analysis/statistics/paired_tests.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/study/study_analysis.hpp"
#include "analysis/study/verdict_table.hpp"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// Numbers of runs, in the same worlds, that each of two cells won. A run that failed in one cell
/// is won by the other.
struct Wins {
  std::size_t won = 0, lost = 0, tied = 0;
  double p = 1.0;       ///< p-value of the exact sign test
  double p_holm = 1.0;  ///< p-value adjusted for all tests of its table

  /// Share of the counted runs that the first cell won; NaN if there are none.
  double share() const;
};

/// Comparison of one cell with the baseline by one score.
struct CellComparison {
  std::string cell;
  const Score* score = nullptr;
  /// Number of runs in which both have a value; the difference is over these.
  std::size_t pairs = 0;
  std::size_t without = 0;  ///< number of runs in which only the baseline has a value: counted lost
  std::size_t baseline_without =
      0;                     ///< number of runs in which only the cell has a value: counted won
  std::size_t neither = 0;   ///< number of runs that failed in both
  std::size_t unpaired = 0;  ///< number of runs that ended in only one of the two cells
  double mean = kNaN, baseline_mean = kNaN;  ///< means over the pairs
  double difference = kNaN;                  ///< mean - baseline_mean
  Interval interval{};                       ///< interval of the difference
  bool has_heavy_tail = false;               ///< whether a heavy tail makes the interval invalid
  double ratio = kNaN;                       ///< mean / baseline_mean; NaN if !Score::has_ratio
  /// Expectation of a NEES, by which tables divide it; 1 for other scores.
  double expectation = 1.0;
  Wins wins{};
  SignedRank rank{};  ///< signed-rank test of the differences
  /// P-value of the signed-rank test, adjusted for all tests of the table.
  double rank_p_holm = 1.0;

  /// The finding: "better", "worse" or "undecided"; "lower" or "higher" if neither direction is
  /// better. If only the tests over runs show it, and not the interval of the mean difference, it
  /// is "better in most runs" or "in all runs", or "mixed" if that interval lies on the other side.
  std::string verdict(double level) const;
};

/// The cell whose numbers are compared with those of the other: that of the row, or the baseline.
enum class SeenFrom { cell, baseline };

/// Comparisons of every other cell with a baseline.
struct Comparisons {
  std::string baseline;
  /// Level of intervals; tests are at 1 - level, by Holm over the whole table.
  double level = kUsualLevel;
  std::vector<CellComparison> rows;  ///< comparisons score by score, in the order of the cells
  SeenFrom seen_from = SeenFrom::cell;
};

/// The comparisons of a baseline with every other cell, each the other way round.
Comparisons seen_from_baseline(Comparisons comparisons);

/// A number that is negative if `left` is the better of two values of a score.
double disadvantage(const Score& score, double left, double right);

Wins wins_of(const CellAnalysis& left, const CellAnalysis& right, const Score& score);

/// Compares all cells with `baseline` at the study's level. A cell that has no value of a score, or
/// shares no run with the baseline, has no row. Throws StudyError if there is no cell `baseline`.
Comparisons compare_cells(const StudyAnalysis& study, const std::string& baseline,
                          std::span<const Score* const> scores,
                          const Parallel& parallel = Parallel::serial());

/// Scores of accuracy, consistency and cost; without a true path the distance to the leading
/// reference.
std::vector<const Score*> usual_scores(bool has_truth);

/// Comparisons of every cell with every other by one score.
struct WinMatrix {
  const Score* score = nullptr;
  std::vector<std::string> cells;       ///< labels of the cells that can be judged by the score
  std::vector<std::vector<Wins>> wins;  ///< {row, column} wins of the row; empty on the diagonal
};

/// The matrix of a score. Its tests are adjusted for all pairs of the matrix.
WinMatrix win_matrix(const StudyAnalysis& study, const Score& score);

/// A comparison of cells with a baseline and with each other.
struct StudyComparison {
  Comparisons comparisons;
  /// {score by which two cells or more are judged} comparisons of all cells.
  std::vector<WinMatrix> matrices;
};

StudyComparison compare_study(const StudyAnalysis& study, const std::string& baseline,
                              std::span<const Score* const> scores, const Parallel& parallel);

/// Names of the files that write_comparison_csv() makes.
std::vector<std::string> comparison_csv_names();

/// Writes comparison.csv (one row for each cell and score) and wins.csv (one row for each score and
/// ordered pair of cells) into `directory`, which is made if it is missing. Throws RunError naming
/// the file that cannot be written.
void write_comparison_csv(const StudyComparison& comparison,
                          const std::filesystem::path& directory);

/// One sentence for each cell with the scores by which it differs from the baseline, and those by
/// which it is undecided.
std::vector<std::string> comparison_sentences(const Comparisons& comparisons);

/// A table with one row for each cell and score: the difference from the baseline with its
/// interval. A NEES is shown as the NEES ratio.
TextTable difference_table(const Comparisons& comparisons);

/// The number of paired runs, and the reasons why others are not paired, if it is the same in all
/// rows: "64, 1936 unpaired". Else difference_table() has it, and this is empty.
std::string pairs_of_all_rows(const Comparisons& comparisons);
/// The table of the same rows with the tests of each difference.
TextTable comparison_table(const Comparisons& comparisons);
/// A table with one row and one column for each cell: the share of runs in which the row beats the
/// column.
TextTable win_table(const WinMatrix& matrix, double level);

/// Short notes on how to read difference_table().
std::vector<std::string> difference_notes(const StudyAnalysis& study,
                                          const Comparisons& comparisons);
/// Notes on comparison_table(), for readers who do not know p-values.
std::vector<std::string> comparison_notes(const StudyAnalysis& study,
                                          const Comparisons& comparisons);
std::string win_note(double level);

}  // namespace montecarta::analysis
