// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/run_files.hpp"

#include "engine/errors.hpp"

#include <gmock/gmock.h>

namespace montecarta::experiments {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Names = std::vector<std::string>;

const Names kTruths = {"t/run_3/truth.csv", "t/run_4/truth.csv"};

Names labels(const Names& estimates, const Names& truths = kTruths) {
  Names found;
  for (const EstimatorFiles& cell : pair_files(estimates, truths, std::nullopt).cells)
    found.push_back(cell.cell);
  return found;
}

std::string complaint(const Names& estimates, const Names& truths = kTruths) {
  try {
    pair_files(estimates, truths, std::nullopt);
  } catch (const StudyError& error) {
    return error.what();
  }
  return "";
}

TEST(RunFiles, ArePairedByNumber) {
  const JudgedFiles files = pair_files({"r/run_4/e.csv", "r/run_3/e.csv"}, kTruths, "mine");
  EXPECT_THAT(files.runs, ElementsAre(3, 4));
  EXPECT_THAT(files.truth, ElementsAre(kTruths[0], kTruths[1]));
  ASSERT_EQ(files.cells.size(), 1U);
  EXPECT_EQ(files.cells[0].cell, "mine");
  EXPECT_THAT(files.cells[0].of_run, ElementsAre("r/run_3/e.csv", "r/run_4/e.csv"));
}

TEST(RunFiles, NameTheirEstimator) {
  EXPECT_THAT(labels({"r/run_3/estimate.csv", "r/run_4/estimate.csv"}), ElementsAre("estimate"));
  EXPECT_THAT(labels({"ekf/run_3.csv", "ekf/run_4.csv"}), ElementsAre("ekf"));
  EXPECT_THAT(labels({"ekf/3/e.csv", "ekf/4/e.csv", "pf/3/e.csv", "pf/4/e.csv"}),
              ElementsAre("ekf", "pf"));
  EXPECT_THAT(labels({"r/run_3/ekf2.csv", "r/run_4/ekf2.csv", "r/run_3/pf.csv", "r/run_4/pf.csv"}),
              ElementsAre("ekf2", "pf"));
  EXPECT_THAT(labels({"ekf_3.csv", "ekf_4.csv", "pf_3.csv", "pf_4.csv"}), ElementsAre("ekf", "pf"));
}

TEST(RunFiles, OneTruthIsThatOfAllRunsAndOneEstimateNeedsNoNumber) {
  const JudgedFiles files = pair_files({"e_0.csv", "e_1.csv"}, {"truth.csv"}, std::nullopt);
  EXPECT_THAT(files.truth, ElementsAre("truth.csv", "truth.csv"));
  EXPECT_THAT(pair_files({"mine.csv"}, {"truth.csv"}, std::nullopt).runs, ElementsAre(0));
}

TEST(RunFiles, ThatDoNotFitAreNamed) {
  EXPECT_THAT(complaint({"r/run_3/e.csv"}), HasSubstr("t/run_4/truth.csv: run 4 has no estimate"));
  EXPECT_THAT(complaint({"r/run_3/e.csv", "r/run_4/e.csv", "r/run_5/e.csv"}),
              HasSubstr("r/run_5/e.csv: run 5 has no truth"));
  EXPECT_THAT(complaint({"r/run_3/e.csv", "r/run_5/e.csv"}),
              HasSubstr("r/run_5/e.csv: runs 4 to 4 are missing"));
  EXPECT_THAT(complaint({"a.csv", "b.csv"}), HasSubstr("a.csv: of which run?"));
  EXPECT_THAT(complaint({"r/run_3.csv", "r/run_03.csv"}), HasSubstr("run 3 again"));
  EXPECT_THAT(complaint({"a/run_3.csv", "a/run_4.csv", "b/run_3.csv"}),
              HasSubstr("run 4 has no estimate in cell b"));
  EXPECT_THAT(complaint({"a b/run_3.csv", "a b/run_4.csv"}), HasSubstr("cannot label a cell"));
}

TEST(PairFiles, GivesASingleTruthToAllRunsUnlessItIsOfOne) {
  const Names estimates = {"e/1.csv", "e/2.csv"};
  EXPECT_EQ(pair_files(estimates, {"truth.csv"}, std::nullopt).truth[1], "truth.csv");
  EXPECT_EQ(pair_files(estimates, {"2026/truth.csv"}, std::nullopt).truth.size(), 2U);
  EXPECT_THAT(complaint(estimates, {"t/run_0000/reference.csv"}), HasSubstr("has no truth"));
  EXPECT_THAT(complaint(estimates, {"t/run_0001/reference.csv"}), HasSubstr("run 2 has no truth"));
  EXPECT_THAT(complaint({"e/99999999999.csv", "e/2.csv"}), HasSubstr("of which run?"));
  const JudgedFiles alone = pair_files({"mine.csv"}, {"t/run_0007/reference.csv"}, std::nullopt);
  EXPECT_EQ(alone.truth.size(), 1U);
}

}  // namespace
}  // namespace montecarta::experiments
