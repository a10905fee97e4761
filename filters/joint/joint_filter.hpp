// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "filters/setup/filter_setup.hpp"

#include <memory>

namespace montecarta::filters {

/// EKF-SLAM: one Gaussian over the pose and all landmarks (EQUATIONS 15), detections
/// used one by one in the order of the scan.
std::unique_ptr<SlamFilter> make_ekf_slam(const FilterSetup& setup);

/// The same with the error of Barrau, which pose and map share as one rigid motion: what nobody
/// can observe, where the map lies in the world, no detection is taken to tell.
std::unique_ptr<SlamFilter> make_riekf_slam(const FilterSetup& setup);

/// Their lines in the table of filters.
FilterKind ekf_slam_kind();
FilterKind riekf_slam_kind();
/// EKF-SLAM whose linearised system has the right unobservable directions (EQUATIONS 15).
FilterKind fej_ekf_slam_kind();
FilterKind oc_ekf_slam_kind();
/// EKF-SLAM in the frame of the vehicle.
FilterKind robocentric_ekf_slam_kind();
/// EKF-SLAM by sigma points instead of derivatives.
FilterKind ukf_slam_kind();

}  // namespace montecarta::filters
