// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/moments/motion_increment.hpp"

namespace montecarta {

/// One control step of `duration` [s] whose noise is averaged instead of linearised: mean and
/// covariance of the vehicle's own displacement are exact in the speed, which enters as a factor,
/// and by Gauss-Hermite quadrature with three nodes in the steering angle. What a linearised step
/// leaves out is that a vehicle whose steering trembles gets less far, and that noise on the speed
/// multiplies noise on the steering. The heading it began with is carried along linearised.
MotionIncrement moved_by_quadrature(const MotionIncrement& before, const Control& control,
                                    double duration, const Belief& belief);

}  // namespace montecarta
