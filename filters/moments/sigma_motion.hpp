// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/moments/motion_increment.hpp"
#include "filters/moments/sigma_rule.hpp"

namespace montecarta {

/// One control step of `duration` [s] by sigma points of (pose, control noise) (EQUATIONS 3). The
/// square root has the heading first: its column alone bends, those of x and y are carried along
/// unchanged. Equal to sending all eleven points through the vehicle.
MotionIncrement moved_by_sigma_points(const MotionIncrement& before, const Control& control,
                                      double duration, const Belief& belief, const SigmaRule& rule);

}  // namespace montecarta
