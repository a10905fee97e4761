// SPDX-License-Identifier: BSD-3-Clause
#include "engine/runs/monte_carlo.hpp"

#include "engine/errors.hpp"
#include "engine/records/merge.hpp"
#include "engine/threads/parallel.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/same_results.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/doubles/scripted_study.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <thread>

namespace montecarta::engine {
namespace {

class MonteCarlo : public testing::Test {
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

TEST_F(MonteCarlo, StoresFailuresAndGoesOn) {
  const StudyPlan plan = scripted_cells(6);
  const RunOutcome outcome = run_study(plan, options("study.h5"));
  EXPECT_EQ(outcome.stopped, StopReason::complete);
  EXPECT_EQ(outcome.runs_here, 12U);
  EXPECT_EQ(outcome.counts.complete, 11U);
  EXPECT_EQ(outcome.counts.failed, 1U);
  EXPECT_EQ(exit_code(outcome, false), 3);

  const ResultFile file(folder / "study.h5");
  const StoredCell& small = file.cells()[0];
  EXPECT_EQ(file.status(small)[3], RunStatus::failed);
  EXPECT_EQ(file.failure_steps(small)[3], 17U);
  EXPECT_EQ(file.failure_reasons(small)[3], "scripted mishap of run 3");
  EXPECT_THAT(file.status(file.cells()[1]), Each(RunStatus::complete));
}

/// Law 1: same study, same bits, for any number of threads and every backend. With 3 runs and 8
/// threads there are spare ones for the loops inside.
TEST_F(MonteCarlo, GivesTheSameBitsOnAnyThreads) {
  for (const std::uint64_t runs : {3, 12}) {
    const StudyPlan plan = scripted_cells(runs);
    const ResultFile serial = results_of(plan, options("serial" + std::to_string(runs)));
    for (const Backend backend : {Backend::tbb, Backend::openmp})
      for (const int threads : {1, 2, 8}) {
        RunOptions how = options("parallel");
        how.parallel = Parallel(backend, threads);
        how.force = true;
        EXPECT_EQ(difference(serial, results_of(plan, how)), "") << threads << " threads";
      }
  }
}

TEST_F(MonteCarlo, GivesTheSameBitsToARunAlone) {
  StudyPlan plan = scripted_cells(6);
  const ResultFile whole = results_of(plan, options("whole"));
  for (const std::uint64_t run : {0, 3, 5}) {
    plan.first_run = run;
    plan.last_run = run + 1;
    const ResultFile alone = results_of(plan, options("alone" + std::to_string(run)));
    EXPECT_EQ(alone.runs(), std::vector<std::uint64_t>{run});
    EXPECT_EQ(difference_of_run(whole, run, alone, 0), "");
  }
}

/// Sends a signal to this process when the filter of run 2 begins.
class SignallingFilter : public ScriptedFilter {
 public:
  SignallingFilter(Script script, std::shared_ptr<std::atomic<int>> signal)
      : ScriptedFilter(script), signal_(std::move(signal)) {}
  void predict(const StepContext& context, const Control& control, double duration) override {
    if (context.run() == 2)
      if (const int signal = signal_->exchange(0); signal != 0) raise(signal);
    ScriptedFilter::predict(context, control, duration);
  }

 private:
  std::shared_ptr<std::atomic<int>> signal_;
};

TEST_F(MonteCarlo, GivesTheSameBitsInterruptedAndResumed) {
  StudyPlan plan = scripted_cells(12);
  const ResultFile whole = results_of(plan, options("whole"));
  for (const int signal : {SIGINT, SIGTERM}) {
    const auto pending = std::make_shared<std::atomic<int>>(signal);
    const ScriptedFilter::Script slow{.particles = SpareThreads::kLeastParticles,
                                      .pace = std::chrono::milliseconds(1)};
    plan.cells[1].make_filter = [=] { return std::make_unique<SignallingFilter>(slow, pending); };
    RunOptions how = options("interrupted" + std::to_string(signal), 2);
    const RunOutcome first = run_study(plan, how);
    EXPECT_EQ(exit_code(first, false), 128 + signal);
    EXPECT_GT(first.runs_here, 0U);
    EXPECT_GT(first.counts.missing, 0U);
    EXPECT_FALSE(std::filesystem::exists(how.output));

    how.resume = true;
    const RunOutcome second = run_study(plan, how);
    EXPECT_EQ(second.stopped, StopReason::complete);
    EXPECT_EQ(second.runs_here, first.counts.missing);
    EXPECT_EQ(difference(whole, ResultFile(how.output)), "");
  }
}

/// Sends a signal when the only run begins, which may end before anybody has seen the signal.
TEST_F(MonteCarlo, ReportsASignalEvenIfNoRunIsMissing) {
  for (const int signal : {SIGINT, SIGTERM}) {
    StudyPlan plan = scripted_study(3, 2);
    const auto pending = std::make_shared<std::atomic<int>>(signal);
    plan.cells = {scripted_cell("small", {.particles = 5})};
    plan.cells[0].make_filter = [=] {
      return std::make_unique<SignallingFilter>(ScriptedFilter::Script{.particles = 5}, pending);
    };
    const RunOutcome outcome = run_study(plan, options("signalled" + std::to_string(signal)));
    EXPECT_EQ(outcome.signal, signal == SIGINT ? StopReason::sigint : StopReason::sigterm);
  }
  EXPECT_EQ(run_study(scripted_cells(2), options("quiet")).signal, StopReason::complete);
}

TEST_F(MonteCarlo, StopsAtTheTimeBudgetAndGoesOnLater) {
  StudyPlan plan = scripted_study(12, 40);
  plan.cells = {scripted_cell("slow", {.pace = std::chrono::milliseconds(5)})};
  RunOptions how = options("study.h5");
  how.time_budget = 0.2;
  const RunOutcome first = run_study(plan, how);
  EXPECT_EQ(first.stopped, StopReason::time_budget);
  EXPECT_EQ(exit_code(first, false), 85);
  EXPECT_GT(first.counts.missing, 0U);
  how.time_budget.reset();
  how.resume = true;
  EXPECT_EQ(run_study(plan, how).runs_here, first.counts.missing);
}

TEST_F(MonteCarlo, HasNothingToDoWhereNothingIsMissing) {
  const StudyPlan plan = scripted_cells(4);
  RunOptions how = options("study.h5");
  run_study(plan, how);
  how.resume = true;
  const RunOutcome again = run_study(plan, how);
  EXPECT_EQ(again.runs_here, 0U);
  EXPECT_EQ(exit_code(again, false), 3) << "run 3 failed long ago";
}

/// Drives of which that of run 30 cannot be read.
class TornDrives : public ScriptedDrives {
 public:
  using ScriptedDrives::ScriptedDrives;
  void generate(std::uint64_t run, Drive& drive) const override {
    if (run == 30) throw RunError("drive.csv: cannot read (the disk is gone)");
    ++n_generated;
    ScriptedDrives::generate(run, drive);
  }
  mutable std::atomic<std::size_t> n_generated{0};
};

TEST_F(MonteCarlo, EndsAllWorkersWhenOneMeetsAnError) {
  for (const Backend backend : {Backend::tbb, Backend::openmp, Backend::serial}) {
    StudyPlan plan = scripted_study(500, 40);
    plan.cells = {scripted_cell("slow", {.pace = std::chrono::microseconds(50)})};
    const auto drives = std::make_shared<TornDrives>(40);
    plan.drives = drives;
    RunOptions how = options("study" + std::to_string(static_cast<int>(backend)));
    how.parallel = Parallel(backend, 2);
    EXPECT_THAT([&] { run_study(plan, how); },
                ThrowsMessage<RunError>(HasSubstr("the disk is gone")));
    EXPECT_LT(drives->n_generated, 250U);
  }
}

/// A filter that fails in every run.
class FailingFilter : public ScriptedFilter {
 public:
  using ScriptedFilter::ScriptedFilter;
  void predict(const StepContext&, const Control&, double) override {
    throw std::runtime_error("fails");
  }
};

/// An error leaves the failed runs, which are results, and no file where no run has ended.
TEST_F(MonteCarlo, KeepsFailedRunsAfterAnError) {
  StudyPlan plan = scripted_study(40, 10);
  plan.cells = {scripted_cell("failing", {.particles = 5})};
  plan.cells[0].make_filter = [] {
    return std::make_unique<FailingFilter>(ScriptedFilter::Script{.particles = 5});
  };
  plan.drives = std::make_shared<TornDrives>(10);  // ends by an error in run 30
  const RunOptions how = options("study.h5");
  EXPECT_THROW(run_study(plan, how), RunError);
  const ResultFile file(folder / "study.h5.part");
  EXPECT_EQ(std::ranges::count(file.status(file.cells()[0]), RunStatus::failed), 30);

  plan.first_run = 30;
  EXPECT_THROW(run_study(plan, options("none.h5")), RunError);
  EXPECT_FALSE(std::filesystem::exists(folder / "none.h5.part"));
}

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

class Rounds : public MonteCarlo {};

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
  EXPECT_EQ(outcome.counts.complete, 63 + kRunsOfRounds);
  EXPECT_EQ(outcome.counts.failed, 1U);
  EXPECT_EQ(outcome.counts.not_needed, kRunsOfRounds - 64);
  EXPECT_EQ(outcome.runs_here, 64 + kRunsOfRounds);
  const ResultFile file(folder / "study.h5");
  const std::vector<RunStatus> status = file.status(file.cells()[0]);
  EXPECT_THAT(std::vector(status.begin() + 64, status.end()), Each(RunStatus::not_needed));
}

// A cell that stops has the first runs of one that does not.
TEST_F(Rounds, ChangeNoRunThatIsMade) {
  const ResultFile all = results_of(scripted_cells(kRunsOfRounds), options("all.h5"));
  const ResultFile some = results_of(stopping_plan(), options("some.h5"));
  for (std::size_t run = 0; run < 64; ++run) EXPECT_EQ(difference_of_run(all, run, some, run), "");
}

/// Raises a signal, or fails, when the cell is asked about for the first time.
StudyPlan disturbed_plan(std::size_t at_cell, std::uint64_t at_runs, int signal) {
  StudyPlan plan = stopping_plan();
  plan.is_enough = [=](const std::filesystem::path& unfinished, std::size_t cell,
                       std::uint64_t runs, const Parallel& parallel) {
    if (cell == at_cell && runs == at_runs) {
      if (signal == 0) throw RunError("the disk is gone");
      raise(signal);
      std::this_thread::sleep_for(std::chrono::milliseconds(500));  // until the watch has seen it
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
    EXPECT_GT(first.counts.missing, 0U);
    how.resume = true;
    EXPECT_EQ(difference(whole, results_of(stopping_plan(), how)), "") << at_runs;
  }
}

// The first cell has marked its runs as not needed when the question about the second fails: asked
// again later, all comes out the same.
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
