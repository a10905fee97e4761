// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/core/slam_filter.hpp"

#include <cstddef>

namespace montecarta::engine {

/// The input of a run: its drive and the times of steps and scans.
struct RunInput {
  const Itinerary& itinerary;
  const Drive& drive;
};

/// Starts `filter` from the prior of the drive or, if there is none, at the start of the itinerary.
inline void start_filter(SlamFilter& filter, const StepContext& context, const RunInput& input) {
  if (input.drive.prior) {
    filter.start_from(context, *input.drive.prior);
  } else {
    filter.start(input.itinerary.start);
  }
}

/// Updates `filter` with scan number `scan` and the fix at its instant, if there is one.
inline void update_with_scan(SlamFilter& filter, const StepContext& context, const RunInput& input,
                             std::size_t scan) {
  if (const auto fix = input.drive.fix(scan)) filter.take_fix(*fix);
  filter.update(context, input.drive.scan(scan));
}

/// Predicts the step of `context`, unless the vehicle stands still, and calls `at_scan(scan)` for
/// the scans that end it, from number `scan` on. `at_scan` calls update_with_scan() and returns
/// whether to go on. Returns false as soon as it does; else `scan` is the number of the next scan.
template <class AtScan>
bool take_step(SlamFilter& filter, const StepContext& context, const RunInput& input,
               std::size_t& scan, const AtScan& at_scan) {
  const auto& [itinerary, drive] = input;
  const std::size_t step = context.step();
  const Control& control = drive.controls[step];
  if (!control.stands(itinerary.moving_controls))
    filter.predict(context, control, itinerary.duration(step));
  for (; scan < itinerary.scans() && itinerary.scan_step[scan] == step; ++scan) {
    if (!at_scan(scan)) return false;
  }
  return true;
}

}  // namespace montecarta::engine
