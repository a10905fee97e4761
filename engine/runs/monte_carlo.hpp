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

/// A study whose cells may stop early is run in rounds. Returns the number of runs after each
/// round: kFirstRound, then twice as many each time, and finally all. If no cell may stop, there is
/// one round.
std::vector<std::uint64_t> rounds_of(const StudyPlan& plan);
inline constexpr std::uint64_t kFirstRound = 32;
/// The rounds of a study of `runs` runs that has cells that may stop early.
std::vector<std::uint64_t> rounds_of(std::uint64_t runs);

/// The result of a session of a study.
struct RunOutcome {
  StopReason stopped = StopReason::complete;
  RunCounts counts = {};        ///< runs of all cells, including earlier sessions
  std::uint64_t runs_here = 0;  ///< number of runs that ended in this session
  double seconds = 0.0;         ///< [s] wall time of this session
  /// Signal (sigterm or sigint) that was received, even if no run was missing any more.
  StopReason signal = StopReason::complete;
};

/// Exit code of the program: 0 done, 3 done with some failed runs, 85 stopped at a checkpoint (by
/// the time budget or by SIGTERM from a scheduler), 130 or 143 interrupted.
int exit_code(const RunOutcome& outcome, bool under_scheduler);

/// The settings of a run of a study. Results do not depend on them.
struct RunOptions {
  std::filesystem::path output;
  Parallel parallel = Parallel::serial();
  bool resume = false;   ///< whether to continue an unfinished file
  bool force = false;    ///< whether to replace a finished or unfinished file
  bool attempt = false;  ///< whether to make one of several attempts, perhaps at once
  std::optional<double> time_budget{};  ///< [s] time after which to stop at a checkpoint
  ProgressStyle progress = ProgressStyle::automatic;
  bool quiet = false;      ///< whether to omit progress and notes on standard error
  TextPairs provenance{};  ///< facts about build, machine and command
};

/// Runs the missing runs of the plan and stores them. Ends early on SIGINT, SIGTERM or when the
/// time budget is exhausted; then the file can be resumed. Throws StudyError if the user must act
/// first, and RunError if the machine fails. Runs stored until then can be resumed too. Work that
/// this call began leaves no file if none of its runs has ended or, after UnusableFilter, if none
/// is complete.
RunOutcome run_study(const StudyPlan& plan, const RunOptions& options);

}  // namespace montecarta::engine
