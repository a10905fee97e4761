// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/runs/plan.hpp"
#include "experiments/study/run_range.hpp"
#include "experiments/study/study.hpp"

#include <optional>

namespace montecarta {

/// The study made ready to run: drives simulated, filters at hand. Without `range` all its runs.
/// Throws StudyError where settings that are right alone do not fit together.
StudyPlan make_plan(const Study& study, std::optional<RunRange> range = std::nullopt);

}  // namespace montecarta
