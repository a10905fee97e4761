// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/bootstrap.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/study/cell_analysis.hpp"
#include "analysis/study/nees_accumulator.hpp"
#include "analysis/study/paired_runs.hpp"
#include "analysis/study/score_table.hpp"
#include "analysis/study/study_analysis.hpp"
#include "analysis/study/study_comparison.hpp"
#include "engine/errors.hpp"
#include "engine/random/stream.hpp"
#include "tests/doubles/matchers.hpp"

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::analysis {
namespace {

using testing::Pair;

/// A cell with runs 0, 1, ... that have these position RMSEs and as many seconds of CPU time; a
/// negative one is a run that failed.
CellAnalysis compared_cell(const std::string& label, const std::vector<double>& rmse,
                           double cpu_seconds = 1.0) {
  CellAnalysis cell;
  cell.label = label;
  for (std::size_t i = 0; i < rmse.size(); ++i) {
    if (rmse[i] < 0.0) {
      cell.failures.push_back({i, 0, "lost"});
      continue;
    }
    const ScoreTable::Value scores[] = {{"position_rmse", rmse[i]}, {"cpu_seconds", cpu_seconds}};
    cell.runs.push_back(i);
    cell.scores.add(scores);
  }
  cell.complete = cell.runs.size();
  return cell;
}

/// A cell of 20 complete runs with these scores, which depend on the run.
template <class ScoresOf>
CellAnalysis scored_cell(const std::string& label, const ScoresOf& scores_of) {
  CellAnalysis cell = compared_cell(label, std::vector<double>(20, 1.0));
  cell.scores = {};
  for (std::size_t i = 0; i < 20; ++i) {
    const std::vector<ScoreTable::Value> scores = scores_of(0.01 * static_cast<double>(i));
    cell.scores.add(scores);
  }
  return cell;
}

StudyAnalysis compared_study(std::vector<CellAnalysis> cells) {
  StudyAnalysis study;
  study.file = "study.h5";
  study.cells = std::move(cells);
  return study;
}

std::vector<const Score*> scores(const std::vector<std::string>& names) {
  std::vector<const Score*> found;
  for (const std::string& name : names) found.push_back(find_score(name));
  return found;
}

/// Errors of runs: one part is common to all cells, the other part is the cell's own.
std::vector<double> errors(std::size_t runs, double mean, std::uint64_t cell) {
  RngStream world({.seed = 1, .purpose = Draw::test}),
      own({.seed = 2 + cell, .purpose = Draw::test});
  std::vector<double> values(runs);
  for (double& value : values) value = mean + std::abs(world.normal()) + 0.1 * own.normal() + 1.0;
  return values;
}

TEST(CompareCells, FindsASmallDifferenceInTheSameWorlds) {
  const StudyAnalysis study = compared_study({compared_cell("base", errors(200, 1.0, 0)),
                                              compared_cell("worse", errors(200, 1.1, 1)),
                                              compared_cell("same", errors(200, 1.0, 2))});
  const Comparisons found = compare_cells(study, "base", scores({"position_rmse"}));
  ASSERT_EQ(found.rows.size(), 2u);
  const Comparisons by_threads =
      compare_cells(study, "base", scores({"position_rmse"}), Parallel(Backend::tbb, 3));
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(by_threads.rows[k].cell, found.rows[k].cell);
    EXPECT_EQ(by_threads.rows[k].interval.lower, found.rows[k].interval.lower);
    EXPECT_EQ(by_threads.rows[k].rank_p_holm, found.rows[k].rank_p_holm);
  }
  const CellComparison& worse = found.rows[0];
  EXPECT_EQ(worse.cell, "worse");
  EXPECT_EQ(worse.verdict(0.95), "worse");
  EXPECT_GT(worse.interval.lower, 0.0);
  EXPECT_LT(worse.interval.lower, 0.1);
  EXPECT_GT(worse.interval.upper, 0.1);
  EXPECT_NEAR(worse.difference, worse.mean - worse.baseline_mean, 1e-12);
  EXPECT_DOUBLE_EQ(worse.ratio, worse.mean / worse.baseline_mean);
  EXPECT_GE(worse.wins.p_holm, worse.wins.p);
  EXPECT_EQ(found.rows[1].verdict(0.95), "undecided");
}

TEST(CompareCells, CountsFailuresAsLostAndLeavesThemOutOfDifferences) {
  const std::vector<double> base(12, 2.0);
  std::vector<double> cell(12, 1.0);
  for (std::size_t i = 0; i < 11; ++i) cell[i] = -1;
  const Comparisons found =
      compare_cells(compared_study({compared_cell("base", base), compared_cell("fragile", cell)}),
                    "base", scores({"position_rmse"}));
  const CellComparison& row = found.rows.at(0);
  EXPECT_EQ(row.pairs, 1u);
  EXPECT_EQ(row.without, 11u);
  EXPECT_DOUBLE_EQ(row.difference, -1.0);
  EXPECT_EQ(row.wins.won, 1u);
  EXPECT_EQ(row.wins.lost, 11u);
  EXPECT_NEAR(row.wins.share(), 1.0 / 12.0, 1e-15);
  EXPECT_EQ(row.verdict(0.95), "worse");  // although its one complete run is the better one
  EXPECT_TRUE(std::isnan(row.interval.lower));
  EXPECT_EQ(pairs_of_all_rows(found), "1, 11 lost by failure");
}

TEST(CompareCells, GivesNoRatioOfAScoreWithoutANaturalZero) {
  using Scores = std::vector<ScoreTable::Value>;
  const CellAnalysis base = scored_cell("base", [](double value) {
    return Scores{{"log_score", value}};
  });
  const CellAnalysis worse = scored_cell("worse", [](double value) {
    return Scores{{"log_score", value + 1.0}};
  });
  const Comparisons found =
      compare_cells(compared_study({base, worse}), "base", scores({"log_score"}));
  EXPECT_TRUE(std::isnan(found.rows.at(0).ratio));
  EXPECT_NEAR(found.rows.at(0).difference, 1.0, 1e-12);
  EXPECT_EQ(found.rows.at(0).verdict(0.95), "worse");
}

TEST(CompareCells, KnowsWhichSideIsBetter) {
  using Scores = std::vector<ScoreTable::Value>;
  const CellAnalysis few = scored_cell("few", [](double value) {
    return Scores{{"ess", 5.0 + value}, {"nees", 5.0 + value}};
  });
  const CellAnalysis many = scored_cell("many", [](double) {
    return Scores{{"ess", 50.0}, {"nees", 50.0}};
  });
  const Comparisons found =
      compare_cells(compared_study({few, many}), "few", scores({"ess", "nees"}));
  EXPECT_EQ(found.rows.at(0).verdict(0.95), "better");
  EXPECT_EQ(found.rows.at(0).wins.won, 20u);
  EXPECT_EQ(found.rows.at(1).verdict(0.95), "higher");
  EXPECT_EQ(found.rows.at(1).wins.lost, 20u);
}

TEST(CompareCells, ScoresThatDifferByRoundingAloneTie) {
  std::vector<double> base(12), same(12);
  for (std::size_t i = 0; i < base.size(); ++i) {
    base[i] = 0.1 + 0.01 * static_cast<double>(i);
    same[i] = base[i] * (1.0 - 1e-15);
  }
  const Comparisons found =
      compare_cells(compared_study({compared_cell("base", base), compared_cell("same", same)}),
                    "base", scores({"position_rmse"}));
  const CellComparison& row = found.rows.at(0);
  EXPECT_EQ(row.wins.tied, 12u);
  EXPECT_EQ(row.rank.n, 0u);
  EXPECT_EQ(row.difference, 0.0);
  EXPECT_EQ(row.verdict(0.95), "undecided");
}

TEST(CompareCells, CountsNoFailureWhereNeitherSideIsBetter) {
  const auto cell = [](const std::string& label, const std::vector<double>& nees) {
    CellAnalysis made = compared_cell(label, nees);
    made.scores = {};
    for (const double value : nees) {
      const ScoreTable::Value scores[] = {{"nees", value}};
      if (value >= 0.0) made.scores.add(scores);
    }
    return made;
  };
  std::vector<double> fragile(12, -1.0);
  fragile[0] = 1.0;
  const Comparisons found = compare_cells(
      compared_study({cell("base", std::vector<double>(12, 2.0)), cell("fragile", fragile)}),
      "base", scores({"nees"}));
  const CellComparison& row = found.rows.at(0);
  EXPECT_EQ(row.without, 11u);
  EXPECT_EQ(row.wins.won, 1u);
  EXPECT_EQ(row.wins.lost, 0u);
  EXPECT_EQ(row.verdict(0.95), "undecided");
  EXPECT_EQ(pairs_of_all_rows(found), "1, 11 failed");
}

TEST(CompareCells, ShowsTheNeesAsItsRatioToTheExpectedOne) {
  using Scores = std::vector<ScoreTable::Value>;
  const auto cell = [](const std::string& label, double nees) {
    CellAnalysis made = scored_cell(label, [&](double value) {
      return Scores{{"nees", nees + value}, {"position_rmse", nees + value}};
    });
    made.nees.push_back({.block = ErrorBlock::pose, .moments = made.leading, .series = {}});
    made.nees.back().series.dimension = 3;
    return made;
  };
  const std::vector<CellAnalysis> cells = {cell("base", 3.0), cell("off", 9.0)};
  const Comparisons found =
      compare_cells(compared_study(cells), "base", scores({"nees", "position_rmse"}));
  EXPECT_NEAR(found.rows.at(0).difference, 6.0, 1e-12);
  const TextTable table = comparison_table(found);
  EXPECT_EQ(table.rows.at(0).at(0), "NEES ratio");
  EXPECT_EQ(table.rows.at(0).at(3), "2.00");
  EXPECT_EQ(table.rows.at(0).at(4), "[2.00, 2.00]");
  EXPECT_EQ(table.rows.at(1).at(0), "position_rmse [m]");
  EXPECT_EQ(table.rows.at(1).at(3), "6.00");
}

// EKF-SLAM has no effective particles: no row, rather than one that it loses.
TEST(CompareCells, LeaveOutWhatDoesNotApply) {
  const CellAnalysis ekf = compared_cell("ekf", {1.0, 2.0});
  CellAnalysis particles = compared_cell("particles", {1.0, 2.0});
  particles.scores = {};
  for (const double rmse : {1.0, 2.0}) {
    particles.scores.add(std::vector<ScoreTable::Value>{{"position_rmse", rmse}, {"ess", 10.0}});
  }
  EXPECT_TRUE(compare_cells(compared_study({ekf, particles}), "ekf", scores({"ess"})).rows.empty());
  EXPECT_THROW(compare_cells(compared_study({ekf}), "efk", scores({"ess"})), StudyError);
}

// Three of four runs a little better, the fourth much worse: most runs and the mean disagree.
TEST(CompareCells, SaysWhereTheMeanIsOnTheOtherSideOfMostRuns) {
  std::vector<double> base(200), risky(200), even(200);
  for (std::size_t i = 0; i < 200; ++i) {
    const double share = static_cast<double>(i % 20) / 20.0;
    base[i] = 10.0 + share;
    risky[i] = base[i] - 0.5 + 20.0 * (i % 4 == 0 ? 1.0 : 0.0);
    even[i] = base[i] - 0.5 + 2.0 * (i % 4 == 0 ? 1.0 : 0.0);
  }
  const Comparisons found =
      compare_cells(compared_study({compared_cell("base", base), compared_cell("risky", risky),
                                    compared_cell("even", even)}),
                    "base", scores({"position_rmse"}));
  EXPECT_GT(found.rows.at(0).interval.lower, 0.0);
  EXPECT_LT(found.rows.at(0).wins.p_holm, 0.05);
  EXPECT_NE(found.rows.at(0).verdict(0.95), "better");
  EXPECT_EQ(found.rows.at(1).verdict(0.95), "better in most runs");
}

TEST(CompareCells, SaysThatAllRunsAreBetterWhereFewDecideTheMean) {
  RngStream stream({.seed = 1, .purpose = Draw::test});
  std::vector<double> base(50, 0.0), good(50, 1.0);
  for (std::size_t i = 0; i < base.size(); ++i) base[i] = 1.0 + std::exp(4.0 * stream.normal());
  double failed = -1.0;
  const auto row_of = [&] {
    const StudyAnalysis study =
        compared_study({compared_cell("base", base), compared_cell("good", good)});
    return compare_cells(study, "base", scores({"position_rmse"})).rows.at(0);
  };
  EXPECT_TRUE(row_of().has_heavy_tail);
  EXPECT_EQ(row_of().verdict(0.95), "better in all runs");
  std::swap(base[3], failed);
  EXPECT_EQ(row_of().verdict(0.95), "better in most runs");
  std::swap(base[3], failed);
  good[7] = base[7];
  EXPECT_EQ(row_of().verdict(0.95), "better in most runs");
}

// One sentence for each cell, which names each score once.
TEST(CompareCells, SayInOneSentenceWhatIsDecidedAndWhatIsNot) {
  using Scores = std::vector<ScoreTable::Value>;
  const auto cell = [](const char* label, double nees) {
    return scored_cell(label, [&](double value) {
      return Scores{{"nees", nees + value}, {"position_rmse", 1.0}};
    });
  };
  const Comparisons found =
      compare_cells(compared_study({cell("base", 5.0), cell("bold", 50.0), cell("twin", 5.0)}),
                    "base", scores({"position_rmse", "nees"}));
  EXPECT_THAT(comparison_sentences(found),
              ElementsAre("bold against base: NEES ratio higher (9.83 times as large); "
                          "undecided: position_rmse.",
                          "twin against base: undecided: position_rmse, NEES ratio."));
  EXPECT_THAT(difference_table(found).rows[0],
              ElementsAre("position_rmse [m]", "bold", "0.00", "1.00", "0.0 %"));
  EXPECT_EQ(pairs_of_all_rows(found), "20");
  Comparisons other = found;
  other.rows.back().unpaired = 3;
  EXPECT_EQ(pairs_of_all_rows(other), "");
  EXPECT_EQ(difference_table(other).rows.back().back(), "20, 3 unpaired");
}

// Two cells without difference, in nine of ten studies at least no false word at 10 %.
TEST(CompareCells, SlowSaysNothingFalseMoreOftenThanItsLevel) {
  const std::vector<const Score*> chosen = scores({"position_rmse"});
  std::size_t false_words = 0;
  constexpr std::size_t kStudies = 400;
  for (std::uint64_t s = 0; s < kStudies; ++s) {
    const auto cell = [&](const char* label, std::uint64_t c) {
      return compared_cell(label, errors(24, 1.0, 10 + 3 * s + c));
    };
    StudyAnalysis study = compared_study({cell("a", 0), cell("b", 1), cell("c", 2)});
    study.level = 0.9;
    const Comparisons found = compare_cells(study, "a", chosen);
    const auto is_false = [&](const CellComparison& row) {
      return row.verdict(0.9) != "undecided";
    };
    false_words += std::ranges::any_of(found.rows, is_false) ? 1 : 0;
  }
  EXPECT_LT(static_cast<double>(false_words) / kStudies, 0.1 + 5.0 * std::sqrt(0.09 / kStudies));
  EXPECT_GT(false_words, 0u);
}

// Rows and columns are two views of the same tests.
TEST(WinMatrix, OfARowAndAColumnAddUp) {
  std::vector<double> good(20, 1.0), bad(20, 2.0), mixed(20, 1.0);
  for (std::size_t i = 0; i < 5; ++i) mixed[i] = -1;
  const StudyAnalysis study = compared_study(
      {compared_cell("good", good), compared_cell("bad", bad), compared_cell("mixed", mixed)});
  const WinMatrix matrix = win_matrix(study, *find_score("position_rmse"));
  ASSERT_EQ(matrix.cells.size(), 3u);
  EXPECT_EQ(matrix.wins[0][1].won, 20u);
  EXPECT_EQ(matrix.wins[1][0].lost, 20u);
  EXPECT_EQ(matrix.wins[0][2].won, 5u);
  EXPECT_EQ(matrix.wins[0][2].tied, 15u);
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_EQ(matrix.wins[r][c].won, matrix.wins[c][r].lost);
      EXPECT_DOUBLE_EQ(matrix.wins[r][c].p_holm, matrix.wins[c][r].p_holm);
    }
  }
  EXPECT_DOUBLE_EQ(matrix.wins[0][1].p_holm, 3.0 * sign_test(20, 0));
  EXPECT_DOUBLE_EQ(matrix.wins[1][2].p_holm, 2.0 * sign_test(5, 15));
  EXPECT_DOUBLE_EQ(matrix.wins[0][2].p_holm, 2.0 * sign_test(5, 15));  // Holm's p do not fall
  EXPECT_THAT(win_table(matrix, 0.95).rows[0], ElementsAre("good", "-", "100.0 % *", "25.0 %"));
}

TEST(WinMatrix, HasNoCellThatIsNotJudged) {
  const StudyAnalysis study =
      compared_study({compared_cell("a", {1.0}), compared_cell("b", {1.0})});
  EXPECT_TRUE(win_matrix(study, *find_score("ess")).cells.empty());
}

const Score& rmse() { return *find_score("position_rmse"); }

TEST(CommonPlaces, AreThoseOfSharedNumbers) {
  const std::vector<std::uint64_t> left = {1, 3, 4, 9}, right = {0, 3, 9, 10};
  EXPECT_THAT(common_places(left, right), ElementsAre(Pair(1, 1), Pair(3, 2)));
  EXPECT_THAT(common_places(left, {}), IsEmpty());
}

TEST(PairedRuns, CountWhatIsMissingOnEitherSide) {
  const CellAnalysis left = compared_cell("left", {1.0, -1, 3.0, -1, 5.0});
  const CellAnalysis right = compared_cell("right", {2.0, 2.0, -1, -1, 4.0, 7.0});
  const PairedRuns pairs = paired_runs(left, right, rmse());
  EXPECT_THAT(pairs.left, ElementsAre(1.0, 5.0));
  EXPECT_THAT(pairs.right, ElementsAre(2.0, 4.0));
  EXPECT_THAT(pairs.differences(), ElementsAre(-1.0, 1.0));
  EXPECT_EQ(pairs.left_alone, 1u);
  EXPECT_EQ(pairs.right_alone, 1u);
  EXPECT_EQ(pairs.neither, 1u);
  EXPECT_EQ(pairs.unpaired, 1u);  // run 5 is not in the left cell
}

// A score that is not a finite number is as good as none: never averaged, never dropped.
TEST(PairedRuns, TakeWhatIsNoNumberForAFailure) {
  const CellAnalysis left = compared_cell("left", {1.0, NAN, INFINITY});
  const CellAnalysis right = compared_cell("right", {2.0, 2.0, 2.0});
  const PairedRuns pairs = paired_runs(left, right, rmse());
  EXPECT_THAT(pairs.left, ElementsAre(1.0));
  EXPECT_EQ(pairs.right_alone, 2u);
}

TEST(PairedRuns, KnowWhatACellIsJudgedBy) {
  EXPECT_TRUE(is_judged_by(compared_cell("some", {1.0, NAN}), rmse()));
  EXPECT_FALSE(is_judged_by(compared_cell("none", {NAN, NAN}), rmse()));
  EXPECT_TRUE(is_judged_by(compared_cell("all failed", {-1, -1}), rmse()));
  EXPECT_FALSE(has_score(compared_cell("all failed", {-1, -1}), rmse()));
}

}  // namespace
}  // namespace montecarta::analysis
