// SPDX-License-Identifier: BSD-3-Clause
#include "engine/runs/run_outcome.hpp"

#include "engine/errors.hpp"

#include <csignal>
#include <cstdlib>

namespace montecarta::engine {
namespace {

constexpr int kSomeRunsFailed = 3;
constexpr int kCheckpoint = 85;

std::uint64_t sum(const RunOutcome& outcome, std::uint64_t CellOutcome::*count) {
  std::uint64_t total = 0;
  for (const CellOutcome& cell : outcome.cells) total += cell.*count;
  return total;
}

}  // namespace

std::uint64_t RunOutcome::failed() const { return sum(*this, &CellOutcome::failed); }
std::uint64_t RunOutcome::missing() const { return sum(*this, &CellOutcome::missing); }

std::uint64_t RunOutcome::ended() const { return sum(*this, &CellOutcome::complete) + failed(); }

int exit_code(const RunOutcome& outcome, bool under_scheduler) {
  switch (outcome.stopped) {
    case StopReason::complete:
      return outcome.failed() > 0 ? kSomeRunsFailed : EXIT_SUCCESS;
    case StopReason::time_budget:
      return kCheckpoint;
    case StopReason::sigterm:
      return under_scheduler ? kCheckpoint : 128 + SIGTERM;
    case StopReason::sigint:
      return 128 + SIGINT;
    case StopReason::error:
      break;
  }
  expect(false, "an error has no outcome: it is thrown");
  return EXIT_FAILURE;
}

bool runs_under_scheduler() { return std::getenv("SLURM_JOB_ID") != nullptr; }

}  // namespace montecarta::engine
