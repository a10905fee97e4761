// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/fast_slam_filters.hpp"

/// The family with `landmarks = anchored` (SPEC 24, last lines): what a filter believes of a
/// landmark is a Gaussian over range and bearing from the pose it was born at. Filters that differ
/// in their landmarks alone are one filter then: srcd_aided is fastslam2, srcd_pf is srcd. Delayed
/// filters, where the pose at birth may not be drawn: delayed.hpp.
namespace montecarta {

template <class Real>
std::unique_ptr<SlamFilter> make_fastslam1_anchored(const FilterSetup& setup) {
  return make_fast_slam<Real>(setup, fast_slam_settings(setup.options),
                              MotionSampling<Real, Anchored>(setup.belief));
}
/// FastSLAM II and its sigma-point kin, which differ in what carries their poses.
template <class Real, class PoseTransform>
std::unique_ptr<SlamFilter> make_anchored(const FilterSetup& setup, const PoseTransform& poses) {
  return make_refined<Real>(setup, poses, Anchored());
}

// Each compiled apart.
extern template std::unique_ptr<SlamFilter> make_fastslam1_anchored<Lanes>(const FilterSetup&);
extern template std::unique_ptr<SlamFilter> make_anchored<Lanes>(const FilterSetup&,
                                                                 const Linearised&);
extern template std::unique_ptr<SlamFilter> make_anchored<Lanes>(const FilterSetup&,
                                                                 const SigmaPoints&);

/// What the option `landmarks` makes of a filter whose poses `poses` carries; `plain(setup)` where
/// it asks for nothing.
template <class PoseTransform, class Plain>
std::unique_ptr<SlamFilter> make_anchored_or(const FilterSetup& setup, const PoseTransform& poses,
                                             const Plain& plain) {
  return are_anchored(setup.options) ? make_anchored<Lanes>(setup, poses) : plain(setup);
}

}  // namespace montecarta
