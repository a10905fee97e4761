// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/plan.hpp"
#include "engine/records/result_writer.hpp"
#include "engine/runs/interruption.hpp"
#include "engine/runs/progress.hpp"
#include "engine/threads/parallel.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::engine {

/// A study whose cells may stop early is run in rounds. After which numbers of runs: kFirstRound,
/// then twice as many each time, and at last all of them. All of them alone where no cell may stop.
std::vector<std::uint64_t> rounds_of(const StudyPlan& plan);
inline constexpr std::uint64_t kFirstRound = 32;
/// Of a study of `runs` runs whose cells may stop early.
std::vector<std::uint64_t> rounds_of(std::uint64_t runs);

/// Between rounds, when the first `runs` runs of every cell have ended: spares the later runs of
/// each cell that says it has enough. Tells how many that were. A study killed in between finds the
/// same answers again, since they follow from the first `runs` runs alone.
std::uint64_t spare_what_is_enough(const StudyPlan& plan, std::uint64_t runs,
                                   const Parallel& parallel, ResultWriter& writer);

/// What has become of the runs of one cell.
struct CellOutcome {
  std::string label;
  std::uint64_t complete = 0;
  std::uint64_t failed = 0;
  std::uint64_t missing = 0;
  std::uint64_t spared = 0;  ///< not needed
};

/// What a session of a study left behind.
struct RunOutcome {
  StopReason stopped = StopReason::complete;
  std::vector<CellOutcome> cells;  ///< in the order of the plan, earlier sittings included
  std::uint64_t runs_here = 0;  ///< complete or failed in this session; counts once for every cell
  double seconds = 0.0;         ///< wall time of this session

  std::uint64_t failed() const;
  std::uint64_t missing() const;
  std::uint64_t ended() const;  ///< complete or failed
};

/// Exit code of the program: 0 done, 3 done but some runs failed, 85 stopped at a checkpoint (time
/// budget, or SIGTERM from a scheduler), 130 or 143 interrupted.
int exit_code(const RunOutcome& outcome, bool under_scheduler);
/// Whether a batch scheduler started this process (SLURM_JOB_ID is set): it is asked to stop, not
/// interrupted.
bool runs_under_scheduler();

/// How a study is to be run; nothing here changes a bit of its results.
struct RunOptions {
  std::filesystem::path output;
  Parallel parallel = Parallel::serial();
  bool resume = false;                  ///< go on with an unfinished file
  bool force = false;                   ///< replace a finished or unfinished one
  bool attempt = false;                 ///< one of several, perhaps at the same time
  std::optional<double> time_budget{};  ///< [s], then stop at a checkpoint
  ProgressStyle progress = ProgressStyle::automatic;
  bool quiet = false;      ///< neither progress nor notes on standard error
  TextPairs provenance{};  ///< how the file was made
};

/// Runs what is missing of the plan and stores it. Ends early on SIGINT, SIGTERM or when the time
/// budget is used up; the file then can be resumed. Throws StudyError where the user must act
/// first, RunError where the machine fails; what is stored by then can be resumed too.
RunOutcome run_study(const StudyPlan& plan, const RunOptions& options);

}  // namespace montecarta::engine
