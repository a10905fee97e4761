// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/moments/motion_increment.hpp"
#include "filters/setup/filter_setup.hpp"

namespace montecarta::filters {

/// How the noise of a control reaches the pose (option `motion`).
enum class Motion {
  linearised,  ///< EQUATIONS 1
  quadrature,  ///< moved_by_quadrature()
  unbiased     ///< moved_by_unbiased_controls()
};

/// The option `motion` of a filter, whose default is textbook linearisation whatever the noise is,
/// or what fits the noise: quadrature, or unbiased where controls were measured.
Parameter linearised_motion_option();
Parameter fitting_motion_option();
/// What a user chose.
Motion motion_of(const FilterOptions& options);

/// One control step of `duration` [s] whose control is a measurement of the true one, rather than
/// what noise is added to: mean and covariance have no bias, given the true control (EQUATIONS 3).
/// Where that is no covariance, as of a vehicle that is slower than the noise of its speed, pivots
/// of its Cholesky factor that are negative count as zero.
MotionIncrement moved_by_unbiased_controls(const MotionIncrement& before, const Control& control,
                                           double duration, const Belief& belief);

/// Adds one control step of `duration` [s], as `motion` says.
void advance(MotionIncrement& increment, const Control& control, double duration,
             const Belief& belief, Motion motion);

}  // namespace montecarta::filters
