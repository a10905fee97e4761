// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/plan.hpp"
#include "experiments/study/stopping_rule.hpp"

#include <cstdint>
#include <string>

namespace montecarta::experiments {

/// Turns the rule into a function that the engine calls between rounds. Failed runs are left out of
/// means and verdicts. A score that is not a number or has a heavy tail is never precise. A verdict
/// is not known if the cell was not tested. Throws StudyError that begins with `place` if the
/// metric is not a score of runs or no result (processor time).
EnoughRuns enough_runs(const StoppingRule& rule, const std::string& place);

/// Description of the rule for `montecarta check`.
std::string in_words(const StoppingRule& rule, std::uint64_t runs);

}  // namespace montecarta::experiments
