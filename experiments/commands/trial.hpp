// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/plan.hpp"

#include <optional>

namespace montecarta::experiments {

/// How long [s] one run of `cell` takes on one thread, from the first part of `drive`: a quarter of
/// a second of it, or all. Nothing where the filter throws at once (the run itself will say why) or
/// is a program that nobody allowed to start.
std::optional<double> trial_seconds(const Cell& cell, const StudyPlan& plan, const Drive& drive);

/// How many runs like the first one have as many steps as all runs of the plan: drives of their own
/// have different lengths.
double runs_like_the_first(const StudyPlan& plan);

}  // namespace montecarta::experiments
