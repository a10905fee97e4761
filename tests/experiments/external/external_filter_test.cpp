// SPDX-License-Identifier: BSD-3-Clause
// Cells that are programs: a fault of one is a failed run, with step and reason.
#include "engine/errors.hpp"
#include "engine/records/result_file.hpp"
#include "engine/runs/monte_carlo.hpp"
#include "experiments/study/known_filters.hpp"
#include "experiments/study/make_plan.hpp"
#include "experiments/text/words.hpp"
#include "tests/analysis/studied_result.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/reader_program.hpp"
#include "tests/doubles/same_results.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <poll.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

namespace montecarta::experiments {
namespace {

/// Studies of the tiny loop with a cell that is a program.
class ExternalStudy : public testing::Test {
 protected:
  /// The line of a cell that runs the scripted program (tests/doubles/scripted_program.cpp).
  static std::string scripted(const std::string& arguments, const std::string& options = "") {
    return "external command=" + in_quotes(MONTECARTA_SCRIPTED_PROGRAM " " + arguments) +
           " label=mine " + options;
  }

  StudyPlan plan_of(const std::string& cell, std::vector<std::string> overrides = {}) const {
    overrides.push_back("cells.cell=" + cell);
    return make_plan(parse_study(kTinyLoop, "tiny.ini", ".", known_filters(), overrides),
                     std::nullopt, ExternalPrograms::allowed);
  }

  /// The result of all runs.
  ResultFile result_of(const std::string& cell, const std::vector<std::string>& overrides = {},
                       int threads = 1) const {
    const std::filesystem::path path = folder_ / ("out" + std::to_string(++files_) + ".h5");
    run_study(plan_of(cell, overrides),
              {.output = path, .parallel = Parallel(Backend::tbb, threads), .quiet = true});
    return ResultFile(path);
  }

  /// Column of run index i of the only cell.
  static std::vector<double> values(const ResultFile& file, const std::string& name,
                                    std::size_t i) {
    const StoredCell& cell = file.cells().front();
    for (const Column& column : cell.columns) {
      if (column.name != name) continue;
      std::vector<double> numbers(column.elements());
      file.read(cell, name, i, numbers);
      return numbers;
    }
    return {};
  }
  /// x of the last pose.
  static double last_x(const ResultFile& file, std::size_t i) {
    const std::vector<double> mean = values(file, "pose_mean", i);
    return mean[mean.size() - 3];
  }

  ScratchFolder folder_;
  mutable int files_ = 0;
};

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
  /// Checks the failure of the first of two runs, and that the second did not suffer, unless every
  /// process fails so. Message N is sent at step 2 N - 1: every second step has a scan.
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

TEST_F(External, ADeadProgramIsReportedWithItsLastWordsAndADeafOneIsNotDead) {
  const Failure failure = first_failure("exit 3");
  EXPECT_EQ(failure.status, RunStatus::failed);
  EXPECT_EQ(failure.step, 5U);
  EXPECT_EQ(failure.reason, "program ended with exit code 7: last words");
  EXPECT_EQ(first_failure("kill 2").reason, "program was killed by signal 9 (Killed)");
  EXPECT_EQ(first_failure("close 2").reason, "program closed its standard input or output");
  EXPECT_EQ(first_failure("exit 0").step, 0U);
  const Failure deaf = first_failure("deaf 2");
  EXPECT_EQ(deaf.reason, "program closed its standard input or output");
  EXPECT_EQ(deaf.step, 5U);
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

TEST_F(External, AProgramMayEndAfterEachRunAndWriteMuchToStandardError) {
  EXPECT_EQ(
      difference(result_of(scripted("runs 1"), {kAtScans}), result_of(scripted(""), {kAtScans})),
      "");
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
  const auto run = [&](const char* runs) { result_of(scripted("exit 0"), {kAtScans, runs}); };
  EXPECT_THAT([&] { run("study.runs=100"); },
              testing::ThrowsMessage<RunError>(HasSubstr("none of its first 8 starts")));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out1.h5.part")) << "it would block the next try";
  EXPECT_NO_THROW(run("study.runs=7")) << "so few failures are results";
}

// Law: no program is left behind, not even one that ignores the end of its input. A program may run
// before the guard knows it, since it is started first: half a second lies between both.
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
      " [ -s pid ] || exit 2; sleep 0.5; kill -9 $ours;"
      " for i in $(seq 1200); do"
      "   grep -q '^State:.[RSD]' /proc/$(cat pid)/status 2> /dev/null || exit 0; sleep 0.05;"
      " done; kill -9 $(cat pid); exit 1";
  EXPECT_EQ(WEXITSTATUS(std::system(script.c_str())), 0) << std::ifstream(folder_ / "said").rdbuf();
}

TEST_F(External, AFileThatIsNoProgramEndsTheStudy) {
  std::ofstream(folder_ / "script") << "no first line\n";
  std::filesystem::permissions(folder_ / "script", std::filesystem::perms::owner_all);
  EXPECT_THAT([&] { result_of("external command=" + (folder_ / "script").string()); },
              testing::ThrowsMessage<RunError>(HasSubstr("(Exec format error)")));
}

TEST_F(External, WhatACommandLacksIsSaid) {
  EXPECT_THAT(complaint_of([&] { plan_of("external label=mine"); }),
              AllOf(StartsWith("--set cells.cell: command = "), HasSubstr("give e.g. command")));
  EXPECT_THAT(complaint_of([&] { plan_of("external command=\"no_such_program -x\""); }),
              HasSubstr("program 'no_such_program' (there is no such file"));
  EXPECT_THAT(complaint_of([&] { plan_of("external command=\"a 'b\""); }), HasSubstr("a quote '"));
  EXPECT_THAT(complaint_of([&] { plan_of("external command=' '"); }), HasSubstr("is empty"));
}

TEST_F(External, TheResolvedTextReadsBack) {
  const StudyPlan plan = plan_of(scripted("say 99 'a, b \\\"c\\\" \\\\ d'"));
  const StudyPlan again =
      make_plan(parse_study(plan.resolved_text, "again.ini", ".", known_filters()));
  EXPECT_EQ(again.resolved_text, plan.resolved_text);
  EXPECT_EQ(again.cells.front().settings, plan.cells.front().settings);
  EXPECT_THROW(again.cells.front().make_filter(), StudyError);  // nobody allowed it
}

// Law: EKF-SLAM in Python and in Octave, as shipped, is the cell ekf_slam.

const std::string kExamples = MONTECARTA_SOURCE_DIR "/experiments/external";

class SlowExternalExample : public ExternalStudy {
 protected:
  /// Every number of every run within 1e-9, relative where it is large.
  void expect_ekf_slam(const std::string& command) const {
    const std::vector<std::string> overrides = {"scenario.noise=matched", "scenario.clutter_rate=1",
                                                "record.columns=pose,covariance,map"};
    const ResultFile ours = result_of("ekf_slam", overrides);
    const ResultFile theirs =
        result_of("external command=" + in_quotes(command) + " answer_limit=300", overrides);
    for (std::size_t i = 0; i < ours.runs().size(); ++i) {
      ASSERT_EQ(theirs.status(theirs.cells().front())[i], RunStatus::complete)
          << theirs.failure_reasons(theirs.cells().front())[i];
      for (const Column& column : ours.cells().front().columns)
        expect_same(ours, theirs, column, i);
    }
  }

 private:
  static void expect_same(const ResultFile& ours, const ResultFile& theirs, const Column& column,
                          std::size_t run) {
    const std::vector<double> a = values(ours, column.name, run);
    const std::vector<double> b = values(theirs, column.name, run);
    ASSERT_EQ(a.size(), b.size()) << column.name;
    for (std::size_t k = 0; k < a.size(); ++k) {
      if (std::isnan(a[k]) && std::isnan(b[k])) continue;
      ASSERT_NEAR(a[k], b[k], 1e-9 * std::max(1.0, std::abs(a[k])))
          << column.name << "[" << k << "], run " << run;
    }
  }
};

TEST_F(SlowExternalExample, Python) {
  if (!python_has("numpy")) GTEST_SKIP() << "numpy (python3-numpy) is not installed";
  expect_ekf_slam("/usr/bin/python3 -B " + kExamples + "/python/ekf_slam.py");
}

TEST_F(SlowExternalExample, Octave) {
  if (!installed("octave-cli")) GTEST_SKIP() << "octave is not installed";
  expect_ekf_slam("octave-cli --quiet --no-init-file --no-history --path " + kExamples +
                  "/octave --eval ekf_slam");
}

}  // namespace
}  // namespace montecarta::experiments
