// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/plan.hpp"

#include <optional>

namespace montecarta::experiments {

/// What one run of a cell takes on one thread.
struct Trial {
  double seconds = 0.0;  ///< of a filter that has been started before
  double bytes = 0.0;  ///< of memory that the filter holds at its end; infinity: more than is free
};

/// From the first part of `drive`: a quarter of a second of it, or all. The time of
/// all steps but the first is taken to grow with the steps, memory with the landmarks that come
/// into view. nullopt if the filter throws at once (the run itself will say why) or is a program
/// that nobody allowed to start.
std::optional<Trial> trial_of(const Cell& cell, const StudyPlan& plan, const Drive& drive);

/// How many runs like the first one have as many steps as all runs of the plan: drives of their own
/// have different lengths.
double runs_like_the_first(const StudyPlan& plan);

}  // namespace montecarta::experiments
