// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/plan.hpp"

namespace montecarta::experiments {

/// How long [s] one run of `cell` takes on one thread, from the first part of `drive`: a quarter of
/// a second of it, or all. Zero where the filter throws at once; the run itself will say why.
double trial_seconds(const Cell& cell, const StudyPlan& plan, const Drive& drive);

}  // namespace montecarta::experiments
