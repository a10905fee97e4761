// SPDX-License-Identifier: BSD-3-Clause
// A finished result to which runs are added: the bits are those of a study of all runs.
#include "engine/records/result_file.hpp"
#include "engine/records/result_layout.hpp"
#include "tests/doubles/same_results.hpp"
#include "tests/experiments/commands/program.hpp"

#include <gtest/gtest.h>

namespace montecarta::experiments {
namespace {

using testing::HasSubstr;

class MoreRuns : public BlinkProgram {
 protected:
  /// A study of `runs` runs into a file.
  Called run(const std::string& out, const std::string& runs,
             const std::vector<std::string>& more = {}) const {
    return call_with({"run", "blink.ini", "-o", out, "--set", "study.runs=" + runs}, more);
  }
  /// The study must be refused, and its result must stay as it was.
  void expect_kept(const std::string& runs, const std::vector<std::string>& more,
                   const std::string& words) const {
    const std::string before = text_of("out.h5");
    const Called called = run("out.h5", runs, more);
    EXPECT_EQ(called.code, 2) << called.err;
    EXPECT_THAT(called.err, HasSubstr(words));
    EXPECT_EQ(text_of("out.h5"), before);
    EXPECT_FALSE(exists("out.h5.part"));
  }
  void expect_the_bits_of_one_study(const std::string& runs,
                                    const std::vector<std::string>& more = {}) const {
    ASSERT_EQ(run("one.h5", runs, more).code, 0);
    const ResultFile extended(folder_ / "out.h5"), one(folder_ / "one.h5");
    EXPECT_EQ(difference(extended, one), "");
    EXPECT_EQ(extended.study_sha256(), one.study_sha256());
    EXPECT_EQ(extended.study_text(), one.study_text());
  }
};

TEST_F(MoreRuns, KeepTheFirstOnesAndComputeTheOthers) {
  ASSERT_EQ(run("out.h5", "3").code, 0);
  const Called called = run("out.h5", "8", {"--resume"});
  EXPECT_EQ(called.code, 0) << called.err;
  EXPECT_THAT(called.err, HasSubstr("6 runs were taken over from out.h5"));
  EXPECT_THAT(called.err, HasSubstr("10 runs in"));
  EXPECT_FALSE(exists("out.h5.part"));
  expect_the_bits_of_one_study("8");
  EXPECT_EQ(call({"verify", "out.h5"}).code, 0);
}

TEST_F(MoreRuns, KeepRunsThatAreStoredInFull) {
  const std::vector<std::string> full = {"--set", "record.full_runs=5"};
  ASSERT_EQ(run("out.h5", "3", full).code, 0);
  ASSERT_EQ(run("out.h5", "8", {"--set", "record.full_runs=5", "--resume"}).code, 0);
  expect_the_bits_of_one_study("8", full);
}

TEST_F(MoreRuns, AreResumedAfterACheckpoint) {
  ASSERT_EQ(run("out.h5", "3").code, 0);
  EXPECT_EQ(run("out.h5", "400", {"--resume", "--time-budget", "0.001"}).code, 85);
  EXPECT_EQ(ResultFile(folder_ / "out.h5").study_runs(), 3U);
  EXPECT_EQ(run("out.h5", "400", {"--resume"}).code, 0);
  expect_the_bits_of_one_study("400");
}

TEST_F(MoreRuns, AreResumedAfterTheCopyWasKilled) {
  ASSERT_EQ(run("out.h5", "200").code, 0);
  int kills = 0;
  for (const char* begun : {"out.h5.part*", "out.h5.part"}) {
    kills += is_killed_at(begun, {"run", "blink.ini", "-o", "out.h5", "--set", "study.runs=2000",
                                  "--resume", "--quiet"});
  }
  EXPECT_GT(kills, 0) << text_of("killed.out");
  EXPECT_EQ(ResultFile(folder_ / "out.h5").study_runs(), 200U);
  EXPECT_EQ(run("out.h5", "2000", {"--resume"}).code, 0);
  expect_the_bits_of_one_study("2000");
}

TEST_F(MoreRuns, ReplaceNoOtherResultThatTookThePlace) {
  ASSERT_EQ(run("out.h5", "3").code, 0);
  ASSERT_EQ(run("out.h5", "400", {"--resume", "--time-budget", "0.001"}).code, 85);
  std::filesystem::rename(folder_ / "out.h5", folder_ / "first.h5");
  ASSERT_EQ(run("other.h5", "3", {"--set", "study.seed=5"}).code, 0);
  std::filesystem::rename(folder_ / "other.h5", folder_ / "out.h5");
  const std::string other = text_of("out.h5");
  EXPECT_EQ(run("out.h5", "400", {"--resume"}).code, 2);
  EXPECT_EQ(text_of("out.h5"), other);
  std::filesystem::rename(folder_ / "first.h5", folder_ / "out.h5");
  EXPECT_EQ(run("out.h5", "400", {"--resume"}).code, 0);
  expect_the_bits_of_one_study("400");
}

TEST_F(MoreRuns, ReplaceADamagedOne) {
  ASSERT_EQ(run("out.h5", "3").code, 0);
  const ResultFile file(folder_ / "out.h5");
  const ResultSlabs slabs = find_slabs(file.path(), file.description());
  std::string text = text_of("out.h5");
  text[slabs.cells[0].columns[0].at(1)] ^= 1;
  write("out.h5", text);
  EXPECT_THAT(run("out.h5", "8", {"--resume"}).err, HasSubstr("5 runs were taken over"));
  expect_the_bits_of_one_study("8");
}

TEST_F(MoreRuns, AreRefusedWhereTheyAreNotTheOnlyDifference) {
  ASSERT_EQ(run("out.h5", "8").code, 0);
  expect_kept("12", {}, "--force");
  expect_kept("12", {"--resume", "--set", "study.seed=5"}, "belongs to another study");
  expect_kept("5", {"--resume"}, "another number of runs");
  expect_kept("12", {"--resume", "--shard", "0/3"}, "another number of runs");
}

TEST_F(MoreRuns, AreRefusedWhereAStoppingRuleChoseTheRuns) {
  const std::vector<std::string> rule = {"--set", "study.until=verdict"};
  ASSERT_EQ(run("out.h5", "40", rule).code, 0);
  expect_kept("80", {"--set", "study.until=verdict", "--resume"}, "study.until");
}

}  // namespace
}  // namespace montecarta::experiments
