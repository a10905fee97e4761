// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/moments/motion_increment.hpp"
#include "filters/moments/sigma_rule.hpp"

namespace montecarta::filters {

/// The method that propagates the noise of a control to the pose (option `motion`).
enum class Motion {
  linearised,  ///< by derivatives (EQUATIONS 1)
  quadrature,  ///< by moved_by_quadrature()
  unbiased     ///< by moved_by_unbiased_controls()
};

/// The option `motion` of a filter, with the default linearised or with one that fits the noise:
/// quadrature, or unbiased if controls are measurements.
Parameter linearised_motion_option();
Parameter fitting_motion_option();
/// The value of the option `motion`.
Motion motion_of(const FilterOptions& options);

/// One control step of `duration` [s] by sigma points of (pose, control noise) (EQUATIONS 3). The
/// square root has the heading first: in the pose only its column is nonlinear, while those of x
/// and y are carried along unchanged; in the controls only the last one is. The result equals that
/// of sending all points through the vehicle, which are eleven for two controls.
MotionIncrement moved_by_sigma_points(const MotionIncrement& before, const Control& control,
                                      double duration, const Belief& belief, const SigmaRule& rule);

/// One control step of `duration` [s] with its noise averaged instead of linearised. Mean and
/// covariance of the displacement in the frame of the vehicle are exact in the controls in which it
/// is linear, and by three Gauss-Hermite nodes in the last one. Linearisation neglects that noise
/// of the steering shortens the distance, and that noise of the speed multiplies noise of the
/// steering. The uncertainty of the initial heading is propagated linearised.
MotionIncrement moved_by_quadrature(const MotionIncrement& before, const Control& control,
                                    double duration, const Belief& belief);

/// One control step of `duration` [s] with a control that is a measurement of the true one, not a
/// command to which noise is added. Mean and covariance are unbiased, given the true control
/// (EQUATIONS 3). If the resulting matrix is not a covariance, for instance if the speed is smaller
/// than its noise, negative pivots of its Cholesky factor count as zero.
MotionIncrement moved_by_unbiased_controls(const MotionIncrement& before, const Control& control,
                                           double duration, const Belief& belief);

/// Adds one control step of `duration` [s] by the method `motion`.
void advance(MotionIncrement& increment, const Control& control, double duration,
             const Belief& belief, Motion motion);

}  // namespace montecarta::filters
