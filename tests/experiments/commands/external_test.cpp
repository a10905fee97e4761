// SPDX-License-Identifier: BSD-3-Clause
// Who starts a program that a study names, and what verify finds out about it.
#include "experiments/text/words.hpp"
#include "tests/experiments/commands/program.hpp"

#include <gmock/gmock.h>

namespace montecarta::experiments {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class ExternalCommands : public Program {
 protected:
  ExternalCommands() { write("blink.csv", kBlinkWorld); }
  /// A study with a cell that runs the scripted program.
  void write_study(const std::string& arguments, const std::string& options = "") const {
    write("study.ini", kBlink + "cell = external command=" +
                           in_quotes(MONTECARTA_SCRIPTED_PROGRAM " " + arguments) + " label=mine " +
                           options + "\n");
  }
  Called run(const std::vector<std::string>& more) const {
    std::vector<std::string> words{"run", "study.ini", "-o", "out.h5", "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    return call(words);
  }
};

TEST_F(ExternalCommands, NothingIsStartedUnasked) {
  write_study("orphan 0 started");
  const Called refused = run({});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("study.ini:"), HasSubstr("scripted_program orphan"),
                                 HasSubstr("add --allow-external")));
  EXPECT_FALSE(exists("out.h5.part"));
  const Called checked = call({"check", "study.ini"});
  EXPECT_EQ(checked.code, 0);
  EXPECT_THAT(checked.out, HasSubstr("external program, mine     ? "));  // nobody knows how long
  EXPECT_FALSE(exists("started"));
  ASSERT_EQ(run({"--allow-external"}).code, 0);
  ASSERT_TRUE(exists("started"));
  std::filesystem::remove(folder_ / "started");
  EXPECT_THAT(call({"verify", "out.h5"}).err, HasSubstr("add --allow-external"));
  EXPECT_EQ(call({"replay", "out.h5", "--cell", "mine", "--run", "1", "-o", "one.h5"}).code, 2);
  EXPECT_EQ(call({"replay", "out.h5", "--cell", "ekf_slam", "--run", "1", "-o", "one.h5"}).code, 0);
  EXPECT_EQ(call({"analyze", "out.h5"}).code, 0);
  EXPECT_EQ(call({"report", "out.h5", "-o", "page"}).code, 0);
  EXPECT_FALSE(exists("started"));
  EXPECT_EQ(call({"check", "study.ini", "--allow-external"}).code, 0);
  EXPECT_TRUE(exists("started"));
}

TEST_F(ExternalCommands, VerifyTellsWhetherAProgramIsDeterministic) {
  write_study("");
  ASSERT_EQ(run({"--allow-external"}).code, 0);
  EXPECT_EQ(call({"verify", "out.h5", "--sample", "9", "--allow-external"}).code, 0);
  EXPECT_EQ(
      call({"replay", "out.h5", "--cell", "mine", "--run", "2", "-o", "one.h5", "--allow-external"})
          .code,
      0);
}

TEST_F(ExternalCommands, VerifyFindsWhatAProgramKeepsFromRunToRun) {
  write_study("count");
  ASSERT_EQ(run({"--allow-external", "--threads", "1"}).code, 0);
  const Called verified = call({"verify", "out.h5", "--sample", "9", "--allow-external"});
  EXPECT_EQ(verified.code, 4);
  EXPECT_THAT(verified.out, HasSubstr("mine, run 2: pose_mean differs"));
}

TEST_F(ExternalCommands, AStopEndsTheWaitAndIsNoFailure) {
  write("study.ini", kBlink);
  const std::string cell = "external command=" + in_quotes(MONTECARTA_SCRIPTED_PROGRAM " hang 0");
  const Called stopped = run({"--allow-external", "--time-budget", "0.2", "--set",
                              "cells.cell=" + cell + " answer_limit=86400"});  // a day
  EXPECT_EQ(stopped.code, 85) << stopped.err;
  EXPECT_THAT(stopped.err, HasSubstr("3 runs are missing"));
  EXPECT_THAT(stopped.err, HasSubstr("--allow-external"));
}

TEST_F(ExternalCommands, FailedRunsAreAResult) {
  write_study("exit 2");
  EXPECT_EQ(run({"--allow-external"}).code, 3);
  EXPECT_THAT(call({"analyze", "out.h5"}).out, HasSubstr("exit code 7: last words"));
}

}  // namespace
}  // namespace montecarta::experiments
