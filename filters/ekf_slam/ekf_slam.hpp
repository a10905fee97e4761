// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/runs/slam_filter.hpp"
#include "filters/factory.hpp"

#include <memory>

namespace montecarta {

/// EKF-SLAM: one Gaussian over the pose and all landmarks (SPEC 24 with one component), detections
/// absorbed one by one in the order of the scan.
std::unique_ptr<SlamFilter> make_ekf_slam(const FilterSetup& setup);

/// Its line in the table of filters.
FilterKind ekf_slam_kind();

}  // namespace montecarta
