// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/plan.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>

namespace montecarta::experiments {

/// A drive of a study and the part of it that a filter is run on.
struct DrivePart {
  const StudyPlan& plan;
  std::uint64_t run;
  const Drive& drive;
  /// Number of scans after which the filter stops.
  std::size_t scans;
  /// The filter is given every n-th scan and the fix at its instant, the first of them with the
  /// index n - 1.
  std::size_t interval = 1;
};

/// Called after each scan, whether the filter was given it or not.
using AfterScan = std::function<void(std::size_t scan, const SlamFilter& filter, bool is_given)>;

/// Called after each step, when the filter was given the scans that end it.
using AfterStep = std::function<void(std::size_t step, const SlamFilter& filter)>;

/// Runs a filter on the part. Returns false if the filter throws or its pose is not finite at a
/// scan; failures of the machine are thrown.
bool run_filter(const DrivePart& part, SlamFilter& filter, const AfterScan& after_scan,
                const AfterStep& after_step = {});

/// The Gaussian of an estimate that proper scores judge (STATISTICS 7).
const PoseMoments& judged_moments(const PoseEstimate& estimate);

}  // namespace montecarta::experiments
