// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/core/slam_filter.hpp"
#include "engine/records/recorder.hpp"
#include "engine/records/run_record.hpp"
#include "engine/runs/stop_request.hpp"
#include "engine/threads/spare_threads.hpp"

#include <cstdint>

namespace montecarta::engine {

/// All that a run depends on besides its filter, and what it may use meanwhile.
struct RunConditions {
  std::uint64_t seed;  ///< of the study
  std::uint64_t run;
  const Itinerary& itinerary;
  const Drive& drive;  ///< of this run
  const SpareThreads& spare_threads;
  const StopRequest& stop;
};

enum class RunEnd { recorded, dropped };

/// Takes `filter` through one run and leaves what `recorder` saw in `record`, marked complete or,
/// where the filter threw or its estimate was not finite, failed with step and reason; rows behind
/// the failure stay NaN. Stops at the next step when asked to: the record then is worthless
/// (dropped). `recorder` belongs to `record`.
[[nodiscard]] RunEnd run_one(const RunConditions& conditions, SlamFilter& filter,
                             Recorder& recorder, RunRecord& record);

}  // namespace montecarta::engine
