// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/run_files.hpp"

#include "tests/doubles/complaint.hpp"
#include "tests/doubles/matchers.hpp"

namespace montecarta::experiments {
namespace {

using Paths = std::vector<std::string>;

JudgedFiles paired(const Paths& estimates, const Paths& truths = {"truth.csv"}) {
  return pair_files(estimates, truths, std::nullopt);
}

Paths labels_in(const JudgedFiles& files) {
  Paths found;
  for (const EstimatorFiles& cell : files.cells) found.push_back(cell.cell);
  return found;
}

std::string refusal_of(const Paths& estimates, const Paths& truths = {"truth.csv"}) {
  return complaint_of([&] { paired(estimates, truths); });
}

TEST(RunNumbers, AreThoseThatVary) {
  const JudgedFiles ends = paired({"r/run_0/ekf_2.csv", "r/run_1/ekf_2.csv"});
  EXPECT_THAT(labels_in(ends), ElementsAre("ekf_2"));
  EXPECT_THAT(ends.runs, ElementsAre(0, 1));
  const JudgedFiles tasks = paired(
      {"job_123_task_4_proc_0.csv", "job_123_task_5_proc_0.csv", "job_123_task_6_proc_0.csv"});
  EXPECT_EQ(tasks.cells.size(), 1U);
  EXPECT_THAT(tasks.runs, ElementsAre(4, 5, 6));
  const JudgedFiles bare = paired({"77_0_0.csv", "77_0_1.csv", "77_1_0.csv", "77_1_1.csv"});
  EXPECT_EQ(bare.cells.size(), 1U);
  EXPECT_THAT(bare.names, ElementsAre("0/0", "0/1", "1/0", "1/1"));
  const JudgedFiles dates = paired({"2024-01-02T10-20-30/e.csv", "2024-01-03T09-20-30/e.csv"});
  EXPECT_THAT(labels_in(dates), ElementsAre("e"));
  EXPECT_EQ(dates.runs.size(), 2U);
  for (const Paths& names :
       {Paths{"job_1_task_0_proc_0.csv", "job_1_task_0_proc_1.csv"},
        Paths{"job_7_task_0_proc_0.csv", "job_8_task_0_proc_0.csv"},
        Paths{"slurm-71_0.csv", "slurm-71_1.csv"}, Paths{"mc001/ekf.csv", "mc002/ekf.csv"},
        Paths{"2024/ekf_seed1.csv", "2024/ekf_seed2.csv"},
        Paths{"ekf/rank_0/0_0.csv", "ekf/rank_1/0_0.csv"}}) {
    EXPECT_EQ(paired(names).cells.size(), 1U) << names[0];
    EXPECT_EQ(paired(names).runs.size(), 2U) << names[0];
  }
  const JudgedFiles twice = paired({"run_0/est_0.csv", "run_1/est_1.csv"});
  EXPECT_THAT(labels_in(twice), ElementsAre("est"));
}

// Several estimators stay apart if both their numbers and those of the runs vary.
TEST(RunNumbers, LeaveThoseOfTheEstimator) {
  const Paths estimators = {"ekf_1", "ekf_2"};
  EXPECT_THAT(labels_in(paired(
                  {"run_0/ekf_1.csv", "run_0/ekf_2.csv", "run_1/ekf_1.csv", "run_1/ekf_2.csv"})),
              ElementsAreArray(estimators));
  EXPECT_THAT(labels_in(paired(
                  {"ekf_1/run_0.csv", "ekf_1/run_1.csv", "ekf_2/run_0.csv", "ekf_2/run_1.csv"})),
              ElementsAreArray(estimators));
  EXPECT_THAT(labels_in(paired({"pf_10_0.csv", "pf_10_1.csv", "pf_100_0.csv", "pf_100_1.csv"})),
              ElementsAre("pf_10", "pf_100"));
}

TEST(RunNumbers, MayBeNames) {
  const Paths seeds = {"seed_42/e.csv", "seed_1337/e.csv", "seed_2024/e.csv"};
  const JudgedFiles files = paired(seeds);
  EXPECT_THAT(files.runs, ElementsAre(0, 1, 2));
  EXPECT_THAT(files.names, ElementsAre("42", "1337", "2024"));
  EXPECT_EQ(files.cells[0].of_run[1], seeds[1]);
  EXPECT_THAT(note_on_names(files), HasSubstr("42, 1337, 2024"));
  const JudgedFiles own =
      paired(seeds, {"t/seed_2024/t.csv", "t/seed_1337/t.csv", "t/seed_42/t.csv"});
  EXPECT_EQ(own.truth[0], "t/seed_42/t.csv");
  EXPECT_THAT(refusal_of(seeds, {"t/seed_42/t.csv", "t/seed_1337/t.csv"}),
              HasSubstr("seed_2024/e.csv: run 2024 has no truth (3 runs there, 2 runs here)"));
  EXPECT_EQ(note_on_names(paired({"e_1.csv", "e_2.csv"})), "");
  EXPECT_EQ(paired({"e_99999999999.csv", "e_2.csv"}).runs.size(), 2U);
}

TEST(RunNumbers, WithAGapLackARun) {
  Paths runs;
  for (const int run : {0, 1, 2, 4, 5, 6, 7, 8, 9}) runs.push_back(std::to_string(run) + "/e.csv");
  EXPECT_THAT(refusal_of(runs), HasSubstr("4/e.csv: run 3 is missing"));
  EXPECT_THAT(refusal_of({"e_1.csv", "e_2.csv", "e_5.csv", "e_6.csv", "e_7.csv"}),
              HasSubstr("e_5.csv: runs 3 to 4 are missing"));
  EXPECT_THAT(refusal_of({"run_3.csv", "run_5.csv"}), HasSubstr("run 4 is missing"));
}

const Paths kTruths = {"t/run_3/truth.csv", "t/run_4/truth.csv"};

TEST(RunFiles, ArePairedByNumber) {
  const JudgedFiles files = pair_files({"r/run_4/e.csv", "r/run_3/e.csv"}, kTruths, "mine");
  EXPECT_THAT(files.runs, ElementsAre(3, 4));
  EXPECT_THAT(files.truth, ElementsAre(kTruths[0], kTruths[1]));
  ASSERT_EQ(files.cells.size(), 1U);
  EXPECT_EQ(files.cells[0].cell, "mine");
  EXPECT_THAT(files.cells[0].of_run, ElementsAre("r/run_3/e.csv", "r/run_4/e.csv"));
}

TEST(RunFiles, NameTheirEstimator) {
  EXPECT_THAT(labels_in(paired({"r/run_3/estimate.csv", "r/run_4/estimate.csv"}, kTruths)),
              ElementsAre("estimate"));
  EXPECT_THAT(labels_in(paired({"ekf/run_3.csv", "ekf/run_4.csv"}, kTruths)), ElementsAre("ekf"));
  EXPECT_THAT(
      labels_in(paired({"ekf/3/e.csv", "ekf/4/e.csv", "pf/3/e.csv", "pf/4/e.csv"}, kTruths)),
      ElementsAre("ekf", "pf"));
  EXPECT_THAT(
      labels_in(paired({"r/run_3/ekf2.csv", "r/run_4/ekf2.csv", "r/run_3/pf.csv", "r/run_4/pf.csv"},
                       kTruths)),
      ElementsAre("ekf2", "pf"));
  EXPECT_THAT(labels_in(paired({"ekf_3.csv", "ekf_4.csv", "pf_3.csv", "pf_4.csv"}, kTruths)),
              ElementsAre("ekf", "pf"));
}

TEST(RunFiles, OfOneEstimatorMayHaveNames) {
  const Paths runs = {"e/V1_01_easy/est.csv", "e/MH_01_easy/est.csv", "e/MH_04_hard/est.csv"};
  const Paths truths = {"gt/MH_04_hard.csv", "gt/MH_01_easy.csv", "gt/V1_01_easy.csv"};
  const JudgedFiles files = pair_files(runs, truths, "vio");
  EXPECT_THAT(files.names, ElementsAre("MH_01_easy", "MH_04_hard", "V1_01_easy"));
  EXPECT_THAT(files.runs, ElementsAre(0, 1, 2));
  EXPECT_THAT(files.cells[0].of_run, ElementsAre(runs[1], runs[2], runs[0]));
  EXPECT_THAT(files.truth, ElementsAre(truths[1], truths[0], truths[2]));
  EXPECT_THAT(pair_files(runs, {"t.csv"}, "vio").truth, ElementsAre("t.csv", "t.csv", "t.csv"));
  EXPECT_THAT(refusal_of(runs, truths), HasSubstr("--cell NAME"));
  const auto refusal = [](const Paths& estimates, const Paths& of) {
    return complaint_of([&] { pair_files(estimates, of, "vio"); });
  };
  EXPECT_THAT(refusal(runs, {"gt/MH_04_hard.csv", "gt/MH_02_easy.csv", "gt/V1_01_easy.csv"}),
              HasSubstr("e/MH_01_easy/est.csv: no truth is called MH_01_easy"));
  EXPECT_THAT(refusal({runs[0], runs[1]}, truths), HasSubstr("3 truths for 2 runs"));
  EXPECT_THAT(refusal({"a.csv", "b.csv", "./a.csv"}, {"t.csv"}), HasSubstr("is named twice"));
}

TEST(RunFiles, ThatDoNotFitAreNamed) {
  EXPECT_THAT(refusal_of({"r/run_3/e.csv"}, kTruths),
              HasSubstr("t/run_4/truth.csv: run 4 has no estimate"));
  EXPECT_THAT(refusal_of({"r/run_3/e.csv", "r/run_4/e.csv", "r/run_5/e.csv"}, kTruths),
              HasSubstr("r/run_5/e.csv: run 5 has no truth"));
  EXPECT_THAT(refusal_of({"r/run_3/e.csv", "r/run_5/e.csv"}, kTruths),
              HasSubstr("r/run_5/e.csv: run 4"));
  EXPECT_THAT(refusal_of({"a.csv", "b.csv"}, kTruths), HasSubstr("a.csv: has no run number"));
  EXPECT_THAT(refusal_of({"r/run_3.csv", "r/run_03.csv"}, kTruths), HasSubstr("run 3 again"));
  const Paths two = {"r/run_3.csv", "r/run_4.csv"};
  EXPECT_THAT(refusal_of(two, {"a.csv", "b.csv"}),
              AllOf(HasSubstr("a.csv: has no run number"), Not(HasSubstr("--cell"))));
  EXPECT_THAT(refusal_of(two, {"t/run_3.csv", "t/run_03.csv"}),
              AllOf(HasSubstr("run 3 again"), Not(HasSubstr("--cell"))));
  EXPECT_THAT(refusal_of({"a/run_3.csv", "a/run_4.csv", "b/run_3.csv"}, kTruths),
              HasSubstr("run 4 has no"));
  EXPECT_THAT(refusal_of({"a b/run_3.csv", "a b/run_4.csv"}, kTruths),
              AllOf(HasSubstr("cannot label a cell"), HasSubstr("rename the folder")));
  EXPECT_THAT(complaint_of([] { pair_files({"a.csv"}, {"t.csv"}, "a b"); }),
              HasSubstr("): give another --cell NAME"));
}

TEST(PairFiles, GivesASingleTruthToAllRunsUnlessItIsOfOne) {
  const Paths estimates = {"e/1.csv", "e/2.csv"};
  EXPECT_EQ(pair_files(estimates, {"truth.csv"}, std::nullopt).truth[1], "truth.csv");
  EXPECT_THAT(pair_files({"mine.csv"}, {"truth.csv"}, std::nullopt).runs, ElementsAre(0));
  EXPECT_EQ(pair_files(estimates, {"2026/truth.csv"}, std::nullopt).truth.size(), 2U);
  EXPECT_THAT(refusal_of(estimates, {"t/run_0000/reference.csv"}), HasSubstr("has no truth"));
  EXPECT_THAT(refusal_of(estimates, {"t/run_0001/reference.csv"}), HasSubstr("run 2 has no truth"));
  const JudgedFiles alone = pair_files({"mine.csv"}, {"t/run_0007/reference.csv"}, std::nullopt);
  EXPECT_EQ(alone.truth.size(), 1U);
}

}  // namespace
}  // namespace montecarta::experiments
