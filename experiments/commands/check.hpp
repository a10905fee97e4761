// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/plan.hpp"

#include <optional>

namespace montecarta::experiments {

/// Cost of one run of a cell on one thread.
struct Trial {
  double seconds = 0.0;  ///< [s] time of the steps, without the start of an external program
  /// [byte] memory that the filter holds at the end of the run; infinity if more than is free.
  double bytes = 0.0;
};

/// Runs the first part of `drive`, for a quarter of a second at most, and extrapolates to all of
/// it. The time of all steps but the first is assumed to grow with the number of steps, the memory
/// with the number of landmarks detected. Returns nullopt if the filter throws at once (the run
/// itself will report the reason) or is an external program that may not be started.
std::optional<Trial> trial_of(const Cell& cell, const StudyPlan& plan, const Drive& drive);

/// Number of runs of the length of the first run that together have as many steps as all runs of
/// the plan. It differs from the number of runs if every run is a drive of its own.
double runs_like_the_first(const StudyPlan& plan);

}  // namespace montecarta::experiments
