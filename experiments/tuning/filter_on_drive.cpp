// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/tuning/filter_on_drive.hpp"

#include "engine/errors.hpp"

#include <cmath>
#include <new>

namespace montecarta::experiments {
namespace {

StepContext context_at(const DrivePart& part, std::size_t step) {
  return {part.plan.seed, part.run, static_cast<std::uint32_t>(step), Parallel::serial()};
}

bool is_finite(const PoseMoments& moments) {
  const Pose& mean = moments.mean;
  return std::isfinite(mean.x) && std::isfinite(mean.y) && std::isfinite(mean.heading) &&
         moments.covariance.allFinite();
}

/// Runs the steps until the last scan. Returns whether every estimate was finite.
bool take_steps(const DrivePart& part, SlamFilter& filter, const AfterScan& after_scan) {
  const Itinerary& itinerary = part.plan.drives->itinerary_of(part.run);
  std::size_t scan = 0;
  for (std::size_t step = 0; step < itinerary.steps() && scan < part.scans; ++step) {
    const StepContext context = context_at(part, step);
    const Control& control = part.drive.controls[step];
    if (!control.stands(itinerary.moving_controls))
      filter.predict(context, control, itinerary.duration(step));
    for (; scan < part.scans && itinerary.scan_step[scan] == step; ++scan) {
      const bool is_given = (scan + 1) % part.interval == 0;
      if (is_given) filter.update(context, part.drive.scan(scan));
      const PoseEstimate estimate = filter.estimate();
      if (!is_finite(judged_moments(estimate))) return false;
      after_scan(scan, filter, is_given);
    }
  }
  return true;
}

}  // namespace

bool run_filter(const DrivePart& part, SlamFilter& filter, const AfterScan& after_scan) {
  try {
    if (part.drive.prior) {
      filter.start_from(context_at(part, 0), *part.drive.prior);
    } else {
      filter.start(part.plan.drives->itinerary_of(part.run).start);
    }
    return take_steps(part, filter, after_scan);
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
