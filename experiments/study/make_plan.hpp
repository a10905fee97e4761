// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/plan.hpp"
#include "experiments/external/external_kind.hpp"
#include "experiments/study/run_range.hpp"
#include "experiments/study/study.hpp"

#include <optional>
#include <string>

namespace montecarta::experiments {

/// Why the study cannot store joint estimates, as the end of a StudyError: "(why): remedy"; empty
/// where it can.
std::string objection_to_joint(const Study& study);

/// The same of the column observability.
std::string objection_to_observability(const Study& study);

/// The study made ready to run: drives simulated, filters at hand. Without `range` all its runs.
/// Filters that are programs cannot be made unless those are allowed. Throws StudyError where
/// settings that are right alone do not fit together, or there is no such program.
StudyPlan make_plan(const Study& study, std::optional<RunRange> range = std::nullopt,
                    ExternalPrograms programs = ExternalPrograms::refused);

}  // namespace montecarta::experiments
