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

/// Counts of runs, in the same worlds, in which the first of two cells was better. A run that
/// failed in one of them is won by the other.
struct Wins {
  std::size_t won = 0, lost = 0, tied = 0;
  double p = 1.0;       ///< of the exact sign test
  double p_holm = 1.0;  ///< adjusted for all tests of its table

  /// Share of all counted runs that the first cell won; NaN if there are none.
  double share() const;
};

/// One cell against the baseline by one score.
struct CellComparison {
  std::string cell;
  const Score* score = nullptr;
  std::size_t pairs = 0;    ///< runs in which both have a value: the difference is of them
  std::size_t without = 0;  ///< runs in which only the baseline has one: failed, counted lost
  std::size_t baseline_without = 0;          ///< runs in which only the cell has one: counted won
  std::size_t neither = 0;                   ///< runs that failed in both
  std::size_t unpaired = 0;                  ///< runs that ended in one of the two cells only
  double mean = kNaN, baseline_mean = kNaN;  ///< over the pairs
  double difference = kNaN;                  ///< mean - baseline_mean
  Interval interval{};                       ///< of the difference
  bool has_heavy_tail = false;               ///< which makes that interval worthless
  double ratio = kNaN;                       ///< mean / baseline_mean; NaN if !Score::has_ratio
  double expectation = 1.0;  ///< of a NEES, by which tables divide it; 1 for other scores
  Wins wins{};
  SignedRank rank{};         ///< of the differences
  double rank_p_holm = 1.0;  ///< adjusted for all tests of the table

  /// "better", "worse" or "undecided"; "lower" or "higher" if neither direction is better. If only
  /// the tests over runs show it, and not the interval of the mean difference: "better in most
  /// runs" or "in all runs", or "mixed" if that interval lies on the other side.
  std::string verdict(double level) const;
};

/// Every other cell against one.
struct Comparisons {
  std::string baseline;
  double level =
      kUsualLevel;  ///< of intervals; tests are at 1 - level, by Holm over the whole table
  std::vector<CellComparison> rows;  ///< score by score, in the order of the cells
};

/// Negative if `left` is the better of two values of a score.
double disadvantage(const Score& score, double left, double right);

Wins wins_of(const CellAnalysis& left, const CellAnalysis& right, const Score& score);

/// Cells that have no value of a score, or share no run with the baseline, have no row. The level
/// is the study's. Throws StudyError where there is no cell `baseline`.
Comparisons compare_cells(const StudyAnalysis& study, const std::string& baseline,
                          std::span<const Score* const> scores,
                          const Parallel& parallel = Parallel::serial());

/// Accuracy, consistency and cost; without a true path the distance to the leading reference.
std::vector<const Score*> usual_scores(bool has_truth);

/// Every cell against every other by one score.
struct WinMatrix {
  const Score* score = nullptr;
  std::vector<std::string> cells;       ///< that can be judged by the score
  std::vector<std::vector<Wins>> wins;  ///< {row, column}: of the row; empty on the diagonal
};

/// Tests are adjusted for all pairs of the matrix.
WinMatrix win_matrix(const StudyAnalysis& study, const Score& score);

/// A comparison of cells with a baseline and with each other.
struct StudyComparison {
  Comparisons comparisons;
  std::vector<WinMatrix> matrices;  ///< {score} that two cells or more are judged by
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

/// One sentence for each cell: by which scores it differs from the baseline, and by which it is
/// undecided.
std::vector<std::string> comparison_sentences(const Comparisons& comparisons);

/// One row for each cell and score: the difference from the baseline with its interval. A NEES is
/// shown as the NEES ratio.
TextTable difference_table(const Comparisons& comparisons);
/// The same rows with the tests of each difference.
TextTable comparison_table(const Comparisons& comparisons);
/// One row and one column for each cell: the share of runs in which the row beats the column.
TextTable win_table(const WinMatrix& matrix, double level);

/// How to read difference_table(), in short.
std::vector<std::string> difference_notes(const StudyAnalysis& study,
                                          const Comparisons& comparisons);
/// Notes on comparison_table(), for readers who do not know p-values.
std::vector<std::string> comparison_notes(const StudyAnalysis& study,
                                          const Comparisons& comparisons);
std::string win_note(double level);

}  // namespace montecarta::analysis
