// SPDX-License-Identifier: BSD-3-Clause
#include "engine/errors.hpp"
#include "engine/records/result_file.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/doubles/scripted_result.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace montecarta::engine {
namespace {

/// Runs `work` in a child process, which then leaves without cleaning up; returns its process id.
template <class Work>
pid_t in_child(const Work& work) {
  const pid_t child = ::fork();
  if (child != 0) return child;
  try {
    work();
  } catch (const RunError& error) {
    ::_exit(std::string(error.what()).find("--resume") != std::string::npos ? 7 : 8);
  } catch (...) {
    ::_exit(9);
  }
  ::_exit(0);
}

int wait_for_exit(pid_t child) {
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

std::size_t count_whole_runs(const std::filesystem::path& part) {
  const ResultFile file(part);
  std::size_t whole = 0;
  for (const StoredCell& cell : file.cells()) {
    for (RunStatus status : file.status(cell)) whole += status == RunStatus::complete ? 1U : 0U;
  }
  return whole;
}

TEST(ResultSurvival, KilledAtAnyMomentItOpensWithWholeRunsOnly) {
  const StudyPlan plan = small_result_plan(400);
  for (int delay_ms : {5, 20, 60}) {
    const ScratchFolder folder;
    ResultWriter::create(folder / "out.h5", plan, {}, Existing::refuse);
    const pid_t child = in_child([&] {
      ResultWriter writer = ResultWriter::resume(folder / "out.h5", plan, {});
      for (std::uint64_t run = 0; run < plan.runs; ++run) store_run(writer, plan, run);
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(delay_ms));
    ::kill(child, SIGKILL);
    wait_for_exit(child);
    const std::size_t claimed = count_whole_runs(folder / "out.h5.part");
    const ResultWriter writer = ResultWriter::resume(folder / "out.h5", plan, {});
    EXPECT_TRUE(writer.notes().empty()) << writer.notes().front();  // no claimed run was torn
    std::size_t whole = 0;
    for (std::size_t run = 0; run < plan.runs; ++run) {
      for (std::size_t cell : {0U, 1U})
        whole += writer.status(cell, run) == RunStatus::complete ? 1U : 0U;
    }
    EXPECT_EQ(whole, claimed);
  }
}

TEST(ResultSurvival, AFullDiskIsAnErrorThatKeepsWhatIsStored) {
  const ScratchFolder folder;
  const StudyPlan plan = small_result_plan(200);
  ResultWriter::create(folder / "out.h5", plan, {}, Existing::refuse);
  const pid_t child = in_child([&] {
    ResultWriter writer = ResultWriter::resume(folder / "out.h5", plan, {});
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{1'000'000, 1'000'000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    for (std::uint64_t run = 0; run < plan.runs; ++run) store_run(writer, plan, run);
  });
  EXPECT_EQ(wait_for_exit(child), 7);
  ResultWriter writer = ResultWriter::resume(folder / "out.h5", plan, {});
  EXPECT_TRUE(writer.notes().empty());
}

TEST(ResultSurvival, AFullDiskWhileLayingOutLeavesNothing) {
  const ScratchFolder folder;
  const StudyPlan plan = small_result_plan(200);
  const pid_t child = in_child([&] {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{10'000, 10'000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    ResultWriter::create(folder / "out.h5", plan, {}, Existing::refuse);
  });
  EXPECT_EQ(wait_for_exit(child), 8);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace montecarta::engine
