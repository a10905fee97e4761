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

/// What a gate lets pass. More than these are inconsistent whatever the NEES.
struct Allowance {
  std::uint64_t failed = 0;    ///< runs
  std::uint64_t unusable = 0;  ///< samples
};

/// The answer that a verdict gives within its margin. Throws StudyError if the verdict is
/// `untested` and nothing failed: there was nothing to judge.
Gate gate(const Consistency& found, const Allowance& allowed = {});

}  // namespace montecarta::analysis
