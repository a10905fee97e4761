// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/runs/stop_request.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace montecarta::engine {

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

}  // namespace montecarta::engine
