// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/benchmark/matrix.hpp"

#include "experiments/benchmark/matrix_figure.hpp"
#include "tests/doubles/matchers.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>

namespace montecarta::experiments {
namespace {

ArchiveEntry placed(const std::string& world, const std::string& label,
                    std::vector<double> position_rmse) {
  ArchiveEntry entry{.world = world, .label = label, .cell = label + " label=" + label};
  entry.verdict = {.answer = Answer::optimistic, .ratio = 2.0};
  entry.runs = position_rmse.size();
  entry.scores[kArchivedPositionRmse] = std::move(position_rmse);
  return entry;
}

TEST(Matrix, EveryClassOfVerdictHasItsOwnMarkAndColour) {
  std::set<std::string> marks, colours;
  for (const VerdictClass& one : verdict_classes()) {
    marks.insert(one.mark);
    colours.insert(one.colour);
  }
  EXPECT_EQ(marks.size(), verdict_classes().size());
  EXPECT_EQ(colours.size(), verdict_classes().size());
  const auto mark = [](Answer answer, bool is_slight = false) {
    return std::string(class_of({.answer = answer, .is_slight = is_slight}).mark);
  };
  EXPECT_EQ(mark(Answer::consistent), "=");
  EXPECT_EQ(mark(Answer::optimistic), "+");
  EXPECT_EQ(mark(Answer::optimistic, true), "~");
  EXPECT_EQ(mark(Answer::conservative), "-");
  EXPECT_EQ(mark(Answer::inconsistent), "!");
  EXPECT_EQ(mark(Answer::undecided), "?");
  EXPECT_EQ(mark(Answer::untested), "*");
}

TEST(Matrix, RelativeErrorIsOverTheRunsThatBothCompleted) {
  const ArchiveEntry smoother = placed("field_easy", "smoother", {1.0, 1.0, kNaN, 1.0});
  EXPECT_DOUBLE_EQ(relative_error(placed("field_easy", "a", {3.0, 4.0, 100.0, kNaN}), smoother),
                   std::sqrt(12.5));
  EXPECT_DOUBLE_EQ(relative_error(placed("field_easy", "a", {2.0}), smoother), 2.0);
  ArchiveEntry elsewhere = placed("field_easy", "a", {2.0});
  elsewhere.drives_sha256 = "other";
  EXPECT_TRUE(std::isnan(relative_error(elsewhere, smoother)));
}

TEST(Matrix, TellsWhatIsMissingFromWhatDoesNotSuit) {
  const std::vector<ArchiveEntry> entries = {placed("field_easy", "smoother", {1.0}),
                                             placed("field_easy", "mine", {2.0}),
                                             placed("known_map", "ekf_slam", {1.0})};
  std::vector<ArchiveEntry> all = entries;
  all[1].cell = "ekf_slam label=mine";
  const Matrix matrix = matrix_of(all);
  EXPECT_THAT(matrix.worlds, ElementsAre("field_easy", "known_map"));
  ASSERT_EQ(matrix.rows.size(), 3U);
  EXPECT_EQ(matrix.rows[0].label, "ekf_slam");  // shipped filters first, in their order
  EXPECT_EQ(matrix.rows[1].label, "smoother");
  EXPECT_EQ(matrix.rows[2].label, "mine");
  EXPECT_EQ(matrix.rows[0].places[0].entry, nullptr);
  EXPECT_TRUE(matrix.rows[0].places[0].suits);
  EXPECT_FALSE(matrix.rows[1].places[1].suits);
  EXPECT_EQ(matrix.rows[2].places[0].relative_error, 2.0);
  const TextTable table = ratio_table(matrix);
  EXPECT_EQ(table.rows[0][1], "none");
  EXPECT_EQ(table.rows[1][2], "-");
  EXPECT_EQ(table.rows[2][1], "2.00 +");
  EXPECT_THAT(legend_text(matrix), AllOf(HasSubstr("A dash"), HasSubstr("not computed")));
}

TEST(Matrix, SaysThatNumbersOfRunsDiffer) {
  std::vector<ArchiveEntry> entries = {placed("field_easy", "ekf_slam", {1.0}),
                                       placed("field_easy", "mine", {2.0})};
  entries.back().cell = "ekf_slam label=mine";
  EXPECT_THAT(legend_text(matrix_of(entries)), Not(HasSubstr("Filters have")));
  entries.front().runs = 2000;
  EXPECT_THAT(legend_text(matrix_of(entries)), HasSubstr("from 1 to 2000 runs"));
}

TEST(Matrix, ShowsARatioOfDivergedRunsAsABound) {
  EXPECT_EQ(ratio_text(1.0 / 3.0), "0.333");
  EXPECT_EQ(ratio_text(99.9), "99.9");
  EXPECT_EQ(ratio_text(1234.5), "1234");
  EXPECT_EQ(ratio_text(5.76e55), "> 1e4");
  EXPECT_EQ(ratio_text(std::numeric_limits<double>::infinity()), "> 1e4");
  std::vector<ArchiveEntry> entries = {placed("field_easy", "ekf_slam", {1.0})};
  entries.front().verdict.ratio = 5.76e55;
  EXPECT_EQ(ratio_table(matrix_of(entries)).rows[0][1], "> 1e4 +");
  EXPECT_EQ(world_table(matrix_of(entries), 0).rows[0][2], "> 1e4");
}

TEST(Matrix, FigureDrawsEachPlaceInTheColourOfItsClass) {
  const std::vector<ArchiveEntry> entries = {placed("field_easy", "a<b", {1.0})};
  const std::string figure = matrix_figure(matrix_of(entries));
  EXPECT_THAT(figure, HasSubstr(class_of(entries.front().verdict).colour));
  EXPECT_THAT(figure, HasSubstr("a&lt;b"));
}

}  // namespace
}  // namespace montecarta::experiments
