// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/paired_runs.hpp"

#include "analysis/comparison/cell_comparison.hpp"
#include "tests/analysis/comparison/compared_cells.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace montecarta::analysis {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

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
