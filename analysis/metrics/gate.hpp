// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/consistency.hpp"

#include <cstdint>
#include <string>

namespace montecarta::analysis {

/// What a script does with a filter: let it pass, stop it, or wait for more runs.
enum class GateAnswer : std::uint8_t { consistent, inconsistent, undecided };

struct Gate {
  GateAnswer answer = GateAnswer::undecided;
  std::string why;  ///< one line without the name of what was judged
};

/// Runs that a verdict is of, and what is in no NEES.
struct JudgedRuns {
  std::uint64_t complete = 0;
  std::uint64_t failed = 0;       ///< ended early
  std::uint64_t unjudged = 0;     ///< of the complete ones: without any NEES; count as failed
  std::uint64_t covariances = 0;  ///< at all scans of the complete runs
  std::uint64_t invalid = 0;      ///< of them: no covariance, so that its scan has no NEES
  std::uint64_t most_failed =
      0;  ///< more failed runs than these are inconsistent whatever the NEES
};

/// The answer that a verdict gives within its margin, wherever the runs came from. Throws
/// StudyError where the verdict is `untested`: there was nothing to judge.
Gate gate(const Consistency& found, const JudgedRuns& runs);

}  // namespace montecarta::analysis
