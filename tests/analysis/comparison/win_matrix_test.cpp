// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/comparison/cell_comparison.hpp"
#include "analysis/comparison/study_comparison.hpp"
#include "tests/analysis/comparison/compared_cells.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace montecarta::analysis {
namespace {

using testing::ElementsAre;

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

}  // namespace
}  // namespace montecarta::analysis
