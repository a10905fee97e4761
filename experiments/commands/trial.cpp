// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/trial.hpp"

#include <chrono>

namespace montecarta::experiments {
namespace {

constexpr double kTrialSeconds = 0.25;

/// One step as the engine takes it; `scan` is the next scan of the itinerary.
void step_through(SlamFilter& filter, const StudyPlan& plan, const Drive& drive, std::size_t k,
                  std::size_t& scan) {
  const Itinerary& itinerary = plan.drives->itinerary_of(plan.first_run);
  const StepContext context(plan.seed, plan.first_run, static_cast<std::uint32_t>(k),
                            Parallel::serial());
  const Control& control = drive.controls[k];
  if (!control.stands(itinerary.moving_controls))
    filter.predict(context, control, itinerary.duration(k));
  if (scan < itinerary.scans() && itinerary.scan_step[scan] == k)
    filter.update(context, drive.scan(scan++));
  (void)filter.estimate();
}

}  // namespace

std::optional<double> trial_seconds(const Cell& cell, const StudyPlan& plan, const Drive& drive) {
  using Clock = std::chrono::steady_clock;
  const std::size_t steps = plan.drives->itinerary_of(plan.first_run).steps();
  const auto begin = Clock::now();
  double seconds = 0.0;
  std::size_t k = 0;
  try {
    const std::unique_ptr<SlamFilter> filter = cell.make_filter();
    filter->start(plan.drives->itinerary_of(plan.first_run).start);
    for (std::size_t scan = 0; k < steps && seconds < kTrialSeconds; ++k) {
      step_through(*filter, plan, drive, k, scan);
      if (k % 64 == 63 || k + 1 == steps)
        seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    }
  } catch (const std::exception&) {
    return std::nullopt;
  }
  return seconds * static_cast<double>(steps) / static_cast<double>(k);
}

double runs_like_the_first(const StudyPlan& plan) {
  if (plan.drives->own_drives() == 0) return static_cast<double>(plan.runs_here());
  const auto steps = [&](std::uint64_t run) {
    return static_cast<double>(plan.drives->itinerary_of(run).steps());
  };
  double all = 0.0;
  for (std::uint64_t run = plan.first_run; run < plan.last_run; ++run) all += steps(run);
  return all / steps(plan.first_run);
}

}  // namespace montecarta::experiments
