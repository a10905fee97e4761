// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/setup/filter_kind.hpp"
#include "filters/setup/filter_setup.hpp"

#include <memory>

namespace montecarta::filters {

/// EKF-SLAM: one Gaussian over the pose and all landmarks (EQUATIONS 15). Detections are used one
/// by one in the order of the scan.
std::unique_ptr<SlamFilter> make_ekf_slam(const FilterSetup& setup);

/// EKF-SLAM with the right-invariant error of Barrau, in which pose and map move as one rigid body,
/// so that detections give no information about the unobservable pose of the map in the world.
std::unique_ptr<SlamFilter> make_riekf_slam(const FilterSetup& setup);

FilterKind ekf_slam_kind();
FilterKind riekf_slam_kind();
/// EKF-SLAM with the right unobservable directions of the linearised system (EQUATIONS 15).
FilterKind fej_ekf_slam_kind();
FilterKind oc_ekf_slam_kind();
/// EKF-SLAM in the frame of the vehicle.
FilterKind robocentric_ekf_slam_kind();
/// EKF-SLAM by sigma points instead of derivatives.
FilterKind ukf_slam_kind();
/// The same with the error of pose and map as one element of a group, in the axes of the map or of
/// the vehicle.
FilterKind right_ukf_slam_kind();
FilterKind left_ukf_slam_kind();

}  // namespace montecarta::filters
