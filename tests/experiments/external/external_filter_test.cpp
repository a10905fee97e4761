// SPDX-License-Identifier: BSD-3-Clause
// Cells that are programs: what goes wrong with one is a failed run, with step and reason.
#include "engine/errors.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/same_results.hpp"
#include "tests/experiments/external/external_study.hpp"

#include <gmock/gmock.h>

#include <cerrno>
#include <fstream>
#include <poll.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

namespace montecarta::experiments {
namespace {

using testing::AllOf;
using testing::Each;
using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kAtScans = "record.rate=scan";

class External : public ExternalStudy {
 protected:
  struct Failure {
    RunStatus status;
    std::uint32_t step;
    std::string reason;
  };
  static Failure failure_of(const ResultFile& file, std::size_t run) {
    const StoredCell& cell = file.cells().front();
    return {file.status(cell)[run], file.failure_steps(cell)[run], file.failure_reasons(cell)[run]};
  }
  /// Of the first of two runs, and that the second did not suffer, unless every process fails so.
  /// Message N is sent at step 2 N - 1: every second step has a scan.
  Failure first_failure(const std::string& arguments, const std::string& options = "") const {
    const ResultFile file = result_of(scripted(arguments, options), {kAtScans, "study.runs=2"});
    return failure_of(file, 0);
  }
};

TEST_F(External, WhatAProgramSaysIsStored) {
  const ResultFile file = result_of(scripted(""));
  EXPECT_THAT(file.status(file.cells().front()), Each(RunStatus::complete));
  const auto mean = values(file, "pose_mean", 5);
  EXPECT_EQ(mean[0], 1.25);
  EXPECT_EQ(values(file, "nis", 5).back(), 2.5);
  EXPECT_EQ(values(file, "pose_covariance", 5)[4], 1.0);
  EXPECT_EQ(values(file, "final_map_mean", 0)[1], 2.5);
  EXPECT_EQ(values(file, "final_map_seen", 0), (std::vector<double>{1, 0, 0, 0, 0}));
  EXPECT_EQ(file.cells().front().label, "mine");
}

TEST_F(External, OneProcessIsKeptForAllRuns) {
  const ResultFile kept = result_of(scripted("pid"), {kAtScans});
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(last_x(kept, i), last_x(kept, 0));
  const ResultFile fresh = result_of(scripted("pid", "process=new"), {kAtScans});
  EXPECT_NE(last_x(fresh, 1), last_x(fresh, 0));
}

// Law: the same bits on any number of threads, of a program that forgets at `start`.
TEST_F(External, ThreadsChangeNothing) {
  EXPECT_EQ(difference(result_of(scripted(""), {}, 1), result_of(scripted(""), {}, 2)), "");
  const std::string exits = scripted("exit 30");
  EXPECT_EQ(difference(result_of(exits, {}, 1), result_of(exits, {}, 2)), "");
}

TEST_F(External, ProcessesLeaveNoZombieAndInheritNoFile) {
  const ResultFile file = result_of(scripted("descriptors"), {kAtScans});
  EXPECT_EQ(last_x(file, 0), 0.0);
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);
  EXPECT_EQ(errno, ECHILD);
}

TEST_F(External, ADeadProgramIsReportedWithItsLastWords) {
  const Failure failure = first_failure("exit 3");
  EXPECT_EQ(failure.status, RunStatus::failed);
  EXPECT_EQ(failure.step, 5U);
  EXPECT_EQ(failure.reason, "program ended with exit code 7: last words");
  EXPECT_EQ(first_failure("kill 2").reason, "program was killed by signal 9 (Killed)");
  EXPECT_EQ(first_failure("close 2").reason, "program closed its standard input or output");
  EXPECT_EQ(first_failure("exit 0").step, 0U);
}

TEST_F(External, APipeThatNobodyReadsIsNoDeath) {
  EXPECT_EQ(first_failure("deaf 2").reason, "program closed its standard input or output");
  EXPECT_EQ(first_failure("deaf 2").step, 5U);
}

TEST_F(External, AfterAFailureTheNextRunHasANewProcess) {
  const ResultFile file = result_of(scripted("exit 150"), {kAtScans});  // in the second run
  using enum RunStatus;
  EXPECT_THAT(file.status(file.cells().front()),
              testing::ElementsAre(complete, failed, complete, failed, complete, failed));
}

TEST_F(External, SilenceHasALimit) {
  const Failure failure = first_failure("hang 0", "answer_limit=0.01");
  EXPECT_EQ(failure.reason, "program gave no answer within the limit");
  EXPECT_EQ(first_failure("begin 0 {", "answer_limit=0.01").reason, failure.reason);
}

TEST_F(External, WrongAnswersAreReported) {
  EXPECT_THAT(first_failure("say 2 'ans = 5'").reason, StartsWith("answer is not JSON: ans = 5"));
  EXPECT_EQ(first_failure("say 2 '{\"id\":2,\"mean\":[0,0,null]}'").reason, "mean is not a number");
  EXPECT_EQ(first_failure("say 2").step, 3U);
}

TEST_F(External, TooMuchIsReported) {
  EXPECT_EQ(first_failure("flood 2").reason, "program's answer is too long");
  const Failure failure = first_failure("twice 2");  // found by the next message's number
  EXPECT_THAT(failure.reason, StartsWith("answer has not the message's id 3"));
  EXPECT_EQ(failure.step, 5U);
}

TEST_F(External, WhatIsSaidBetweenTwoRunsSpoilsNeither) {
  const ResultFile quiet = result_of(scripted(""), {kAtScans});
  const auto messages = 1 + quiet.scan_times().size() + 1;  // start, scans, final map
  const ResultFile file = result_of(scripted("twice " + std::to_string(messages - 1)), {kAtScans});
  EXPECT_EQ(difference(file, quiet), "");
}

TEST_F(External, AProgramMayEndAfterEachRun) {
  EXPECT_EQ(
      difference(result_of(scripted("runs 1"), {kAtScans}), result_of(scripted(""), {kAtScans})),
      "");
}

TEST_F(External, StandardErrorNeverBlocks) {
  EXPECT_EQ(first_failure("scream 1").status, RunStatus::complete);
}

TEST_F(External, AChildOfTheProgramDiesWithIt) {
  const std::string file = (folder_ / "orphan").string();
  result_of(scripted("orphan 0 " + file), {kAtScans, "study.runs=1"});
  pid_t orphan = 0;
  ASSERT_TRUE(std::ifstream(file) >> orphan);
  const int handle = static_cast<int>(::syscall(SYS_pidfd_open, orphan, 0));
  pollfd end{handle, POLLIN, 0};
  EXPECT_TRUE(handle < 0 || ::poll(&end, 1, 60'000) == 1);
  ::close(handle);
}

// One line says why, instead of as many failed runs as the study has.
TEST_F(External, AProgramThatNeverStartsEndsTheStudy) {
  const auto said = [&](int runs) -> std::string {
    try {
      result_of(scripted("exit 0"), {kAtScans, "study.runs=" + std::to_string(runs)});
    } catch (const RunError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(said(100), AllOf(HasSubstr("none of its first 8 starts"), HasSubstr("last words")));
  EXPECT_EQ(said(7), "") << "so few failures are results";
}

// Law: no program is left behind, not even one that ignores the end of its input.
TEST_F(External, AProgramDoesNotOutliveOursThatWasKilled) {
  std::ofstream(folder_ / "deaf") << "#!/bin/sh\ntrap '' HUP INT TERM PIPE\n"
                                     "echo $$ > pid.new && mv pid.new pid\n"
                                     "while :; do sleep 1; done\n";
  std::filesystem::permissions(folder_ / "deaf", std::filesystem::perms::owner_all);
  std::ofstream(folder_ / "tiny.ini")
      << kTinyLoop << "[cells]\ncell = external command=./deaf label=deaf\n";
  const std::string enter = "cd '" + folder_.path().string() + "'; ";
  const std::string script =
      enter +
      MONTECARTA_EXECUTABLE
      " run tiny.ini -o out.h5 --allow-external --quiet > said 2>&1 & ours=$!; " +
      enter +
      "for i in $(seq 1200); do [ -s pid ] && break; sleep 0.05; done;"
      " [ -s pid ] || exit 2; kill -9 $ours;"
      " for i in $(seq 1200); do"
      "   grep -q '^State:.[RSD]' /proc/$(cat pid)/status 2> /dev/null || exit 0; sleep 0.05;"
      " done; kill -9 $(cat pid); exit 1";
  EXPECT_EQ(WEXITSTATUS(std::system(script.c_str())), 0) << std::ifstream(folder_ / "said").rdbuf();
}

TEST_F(External, AFileThatIsNoProgramEndsTheStudy) {
  std::ofstream(folder_ / "script") << "no first line\n";
  std::filesystem::permissions(folder_ / "script", std::filesystem::perms::owner_all);
  try {
    result_of("external command=" + (folder_ / "script").string());
    FAIL();
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(), HasSubstr("/script' cannot be started (Exec format error)"));
  }
}

TEST_F(External, WhatACommandLacksIsSaid) {
  EXPECT_THAT(complaint_of([&] { plan_of("external label=mine"); }),
              AllOf(StartsWith("--set cells.cell: command = "), HasSubstr("give e.g. command")));
  EXPECT_THAT(complaint_of([&] { plan_of("external command=\"no_such_program -x\""); }),
              HasSubstr("program 'no_such_program' (there is no such file"));
  EXPECT_THAT(complaint_of([&] { plan_of("external command=\"a 'b\""); }),
              HasSubstr("a quote ' is not closed"));
  EXPECT_THAT(complaint_of([&] { plan_of("external command=' '"); }), HasSubstr("is empty"));
}

TEST_F(External, TheResolvedTextReadsBack) {
  const StudyPlan plan = plan_of(scripted("say 99 'a, b \\\"c\\\" \\\\ d'"));
  const StudyPlan again = make_plan(parse_study(plan.resolved_text, "again.ini", "."));
  EXPECT_EQ(again.resolved_text, plan.resolved_text);
  EXPECT_EQ(again.cells.front().settings, plan.cells.front().settings);
  EXPECT_THROW(again.cells.front().make_filter(), StudyError);  // nobody allowed it
}

}  // namespace
}  // namespace montecarta::experiments
