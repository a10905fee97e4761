// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/tuning/filter_on_drive.hpp"

#include "engine/errors.hpp"
#include "engine/runs/step.hpp"

#include <cmath>
#include <new>

namespace montecarta::experiments {
namespace {

StepContext context_at(const DrivePart& part, std::size_t step) {
  return {part.plan.seed, part.run, static_cast<std::uint32_t>(step), Parallel::serial()};
}

engine::RunInput input_of(const DrivePart& part) {
  return {part.plan.drives->itinerary_of(part.run), part.drive};
}

bool is_finite(const PoseMoments& moments) {
  const Pose& mean = moments.mean;
  return std::isfinite(mean.x) && std::isfinite(mean.y) && std::isfinite(mean.heading) &&
         moments.covariance.allFinite();
}

/// Runs the steps until the last scan. Returns whether every estimate was finite.
bool take_steps(const DrivePart& part, SlamFilter& filter, const AfterScan& after_scan,
                const AfterStep& after_step) {
  const engine::RunInput input = input_of(part);
  std::size_t scan = 0;
  for (std::size_t step = 0; step < input.itinerary.steps() && scan < part.scans; ++step) {
    const StepContext context = context_at(part, step);
    const auto at_scan = [&](std::size_t now) {
      if (now >= part.scans) return true;
      const bool is_given = (now + 1) % part.interval == 0;
      if (is_given) engine::update_with_scan(filter, context, input, now);
      if (!is_finite(judged_moments(filter.estimate()))) return false;
      after_scan(now, filter, is_given);
      return true;
    };
    if (!engine::take_step(filter, context, input, scan, at_scan)) return false;
    if (after_step) after_step(step, filter);
  }
  return true;
}

}  // namespace

bool run_filter(const DrivePart& part, SlamFilter& filter, const AfterScan& after_scan,
                const AfterStep& after_step) {
  try {
    engine::start_filter(filter, context_at(part, 0), input_of(part));
    return take_steps(part, filter, after_scan, after_step);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const RunError&) {
    throw;
  } catch (const std::exception&) {
    return false;  // a failure of the filter
  }
}

const PoseMoments& judged_moments(const PoseEstimate& estimate) {
  return estimate.mixture ? *estimate.mixture : estimate.spread;
}

}  // namespace montecarta::experiments
