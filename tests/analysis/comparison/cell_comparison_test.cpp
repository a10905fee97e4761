// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/comparison/cell_comparison.hpp"

#include "analysis/metrics/nees_accumulator.hpp"
#include "analysis/statistics/bootstrap.hpp"
#include "engine/errors.hpp"
#include "engine/random/stream.hpp"
#include "tests/analysis/comparison/compared_cells.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace montecarta::analysis {
namespace {

std::vector<const Score*> scores(const std::vector<std::string>& names) {
  std::vector<const Score*> found;
  for (const std::string& name : names) found.push_back(find_score(name));
  return found;
}

/// Runs whose errors have the worlds' share, common to all cells, and the cell's own.
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
}

TEST(CompareCells, KnowsWhichSideIsBetter) {
  CellAnalysis few = compared_cell("few", std::vector<double>(20, 1.0));
  few.scores = {};
  CellAnalysis many = few;
  many.label = "many";
  for (std::size_t i = 0; i < 20; ++i) {
    const double value = 5.0 + 0.01 * static_cast<double>(i);
    few.scores.add(std::vector<ScoreTable::Value>{{"ess", value}, {"nees", value}});
    many.scores.add(std::vector<ScoreTable::Value>{{"ess", 50.0}, {"nees", 50.0}});
  }
  const Comparisons found =
      compare_cells(compared_study({few, many}), "few", scores({"ess", "nees"}));
  EXPECT_EQ(found.rows.at(0).verdict(0.95), "better");
  EXPECT_EQ(found.rows.at(0).wins.won, 20u);
  EXPECT_EQ(found.rows.at(1).verdict(0.95), "higher");
  EXPECT_EQ(found.rows.at(1).wins.lost, 20u);
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

// Two cells without difference, in nine of ten studies at least no false word at 10 %.
TEST(CompareCells, SaysNothingFalseMoreOftenThanItsLevel) {
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

// Most runs are below the mean of their NEES, so that overconfidence lowers the distance of most.
TEST(NeesDistance, CallsNoCellBetter) {
  EXPECT_EQ(find_score("nees_distance")->better, Better::neither);
}

TEST(NeesDistance, CountsDoublings) {
  EXPECT_DOUBLE_EQ(nees_distance(3.0, 3), 0.0);
  EXPECT_DOUBLE_EQ(nees_distance(6.0, 3), 1.0);
  EXPECT_DOUBLE_EQ(nees_distance(1.5, 3), 1.0);
  EXPECT_TRUE(std::isnan(nees_distance(NAN, 3)));
}

}  // namespace
}  // namespace montecarta::analysis
