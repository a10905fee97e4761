// SPDX-License-Identifier: BSD-3-Clause
#include "engine/runs/rounds.hpp"

#include "engine/errors.hpp"
#include "engine/records/merge.hpp"
#include "engine/runs/monte_carlo.hpp"
#include "tests/doubles/same_results.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/doubles/scripted_study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <thread>

namespace montecarta::engine {
namespace {

using testing::Each;
using testing::ElementsAre;

constexpr std::uint64_t kRunsOfRounds = 150;

/// The small cell has enough at 64, the large one never.
bool small_at_64(const std::filesystem::path& unfinished, std::size_t cell, std::uint64_t runs,
                 const Parallel&) {
  const ResultFile file(unfinished);
  const std::vector<RunStatus> status = file.status(file.cells().at(cell));
  const auto first = status.begin(), last = first + static_cast<std::ptrdiff_t>(runs);
  expect(std::none_of(first, last, [](RunStatus s) { return s == RunStatus::missing; }),
         "asked before all runs have ended");
  return cell == 0 && runs >= 64;
}

StudyPlan stopping_plan() {
  StudyPlan plan = scripted_cells(kRunsOfRounds);
  plan.is_enough = small_at_64;
  return plan;
}

class Rounds : public testing::Test {
 protected:
  RunOptions options(const std::string& name, int threads = 1) const {
    return {.output = folder / name,
            .parallel = Parallel(Backend::tbb, threads),
            .progress = ProgressStyle::none,
            .quiet = true};
  }
  ResultFile results_of(const StudyPlan& plan, const RunOptions& how) const {
    run_study(plan, how);
    return ResultFile(how.output);
  }
  const ScratchFolder folder;
};

TEST_F(Rounds, DoubleUntilAllRunsAreMade) {
  StudyPlan plan = scripted_cells(kRunsOfRounds);
  EXPECT_THAT(rounds_of(plan), ElementsAre(kRunsOfRounds));
  plan.is_enough = small_at_64;
  EXPECT_THAT(rounds_of(plan), ElementsAre(32, 64, 128, kRunsOfRounds));
  plan.last_run = 32;
  EXPECT_THAT(rounds_of(plan), ElementsAre(32));
  EXPECT_THAT(rounds_of(100), ElementsAre(32, 64, 100));
}

TEST_F(Rounds, SpareWhatIsEnough) {
  const StudyPlan plan = stopping_plan();
  const RunOutcome outcome = run_study(plan, options("study.h5"));
  EXPECT_EQ(outcome.stopped, StopReason::complete);
  EXPECT_EQ(outcome.cells[0].complete, 63U);
  EXPECT_EQ(outcome.cells[0].failed, 1U);
  EXPECT_EQ(outcome.cells[0].spared, kRunsOfRounds - 64);
  EXPECT_EQ(outcome.cells[1].complete, kRunsOfRounds);
  EXPECT_EQ(outcome.runs_here, 64 + kRunsOfRounds);
  const ResultFile file(folder / "study.h5");
  const std::vector<RunStatus> status = file.status(file.cells()[0]);
  EXPECT_THAT(std::vector(status.begin() + 64, status.end()), Each(RunStatus::spared));
}

// A cell that stops has the first runs of one that does not.
TEST_F(Rounds, ChangeNoRunThatIsMade) {
  const ResultFile all = results_of(scripted_cells(kRunsOfRounds), options("all.h5"));
  const ResultFile some = results_of(stopping_plan(), options("some.h5"));
  for (std::size_t run = 0; run < 64; ++run) EXPECT_EQ(difference_of_run(all, run, some, run), "");
}

TEST_F(Rounds, GiveTheSameBitsOnAnyThreads) {
  const ResultFile serial = results_of(stopping_plan(), options("serial.h5"));
  for (const int threads : {2, 8}) {
    const ResultFile other = results_of(stopping_plan(), options(std::to_string(threads), threads));
    EXPECT_EQ(difference(serial, other), "") << threads << " threads";
  }
}

/// Raises a signal, or fails, when the cell is asked about for the first time.
StudyPlan disturbed_plan(std::size_t at_cell, std::uint64_t at_runs, int signal) {
  StudyPlan plan = stopping_plan();
  plan.is_enough = [=](const std::filesystem::path& unfinished, std::size_t cell,
                       std::uint64_t runs, const Parallel& parallel) {
    if (cell == at_cell && runs == at_runs) {
      if (signal == 0) throw RunError("the disk is gone");
      raise(signal);
      std::this_thread::sleep_for(std::chrono::seconds(1));  // until the watch has seen it
    }
    return small_at_64(unfinished, cell, runs, parallel);
  };
  return plan;
}

TEST_F(Rounds, GiveTheSameBitsInterruptedAndResumed) {
  const ResultFile whole = results_of(stopping_plan(), options("whole.h5"));
  for (const std::uint64_t at_runs : {32, 64, 128}) {
    RunOptions how = options("interrupted" + std::to_string(at_runs), 2);
    const RunOutcome first = run_study(disturbed_plan(1, at_runs, SIGINT), how);
    EXPECT_GT(first.missing(), 0U);
    how.resume = true;
    EXPECT_EQ(difference(whole, results_of(stopping_plan(), how)), "") << at_runs;
  }
}

// The first cell has spared its runs when the question about the second fails: asked again later,
// all comes out the same.
TEST_F(Rounds, GiveTheSameBitsAfterAnError) {
  const ResultFile whole = results_of(stopping_plan(), options("whole.h5"));
  RunOptions how = options("study.h5");
  EXPECT_THROW(run_study(disturbed_plan(1, 64, 0), how), RunError);
  how.resume = true;
  EXPECT_EQ(difference(whole, results_of(stopping_plan(), how)), "");
}

TEST_F(Rounds, AreMergedLikeAnyOther) {
  const ResultFile whole = results_of(stopping_plan(), options("whole.h5"));
  const std::filesystem::path part = folder / "whole.h5", merged = folder / "merged.h5";
  EXPECT_EQ(merge_results(merged, {part, part}, Existing::refuse).runs, kRunsOfRounds);
  EXPECT_EQ(difference(whole, ResultFile(merged)), "");
}

}  // namespace
}  // namespace montecarta::engine
