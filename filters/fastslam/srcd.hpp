// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/fast_slam_filters.hpp"
#include "filters/fastslam/sigma_point_options.hpp"

namespace montecarta {

inline SigmaPoints srcd_points(const FilterSetup& setup) {
  return central_difference_points(setup, map_uncertainty(setup.options));
}

/// SRCD-FastSLAM (Ankishan 2016; EQUATIONS 8): FastSLAM II with every Gaussian carried by central
/// differences. Covariances are kept, and the factor is taken where points are drawn: the same
/// numbers as the square-root recursion, to rounding.
template <class Real>
std::unique_ptr<SlamFilter> make_srcd(const FilterSetup& setup) {
  const SigmaPoints points = srcd_points(setup);
  return make_refined<Real>(setup, points, points);
}

/// SRCD-aided FastSLAM (EQUATIONS 8): the poses of FastSLAM II, landmarks by central differences.
template <class Real>
std::unique_ptr<SlamFilter> make_srcd_aided(const FilterSetup& setup) {
  return make_refined<Real>(setup, Linearised(),
                            central_difference_points(setup, MapUncertainty::on));
}

/// SRCD-particle-filter based FastSLAM (EQUATIONS 8): poses by central differences, the landmarks
/// of FastSLAM II.
template <class Real>
std::unique_ptr<SlamFilter> make_srcd_pf(const FilterSetup& setup) {
  return make_refined<Real>(setup, srcd_points(setup), Linearised());
}

/// Options of a filter that uses central differences, in the order in which they are documented.
inline std::vector<Option> srcd_options() {
  std::vector<Option> options = sigma_point_options();
  for (Option& option : central_difference_options()) options.push_back(std::move(option));
  return options;
}

}  // namespace montecarta
