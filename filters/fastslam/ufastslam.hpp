// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/fast_slam_filters.hpp"
#include "filters/fastslam/sigma_point_options.hpp"

namespace montecarta {

/// The scaled unscented transform of every stage (EQUATIONS 7): dimension 5 for motion (pose,
/// control) and for a sight (pose, landmark), 2 for a landmark.
inline SigmaPoints unscented_points(const FilterSetup& setup) {
  const auto rule = [&](double n) {
    return unscented_rule(n, setup.options.number("alpha"), setup.options.number("beta"),
                          setup.options.number("kappa"));
  };
  return SigmaPoints({.motion = rule(5), .pose = rule(5), .landmark = rule(2)}, setup.belief,
                     map_uncertainty(setup.options));
}

/// Unscented FastSLAM (Kim 2008): FastSLAM II with every Gaussian carried by the unscented
/// transform.
template <class Real>
std::unique_ptr<SlamFilter> make_ufastslam(const FilterSetup& setup) {
  const SigmaPoints unscented = unscented_points(setup);
  return make_refined<Real>(setup, unscented, unscented);
}

}  // namespace montecarta
