// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/plan.hpp"
#include "engine/records/result_writer.hpp"
#include "engine/runs/progress.hpp"
#include "engine/runs/run_outcome.hpp"
#include "engine/threads/parallel.hpp"

#include <filesystem>
#include <optional>

namespace montecarta::engine {

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
