// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/fast_slam_filters.hpp"
#include "filters/moments/sigma_sight.hpp"

#include <memory>
#include <vector>

/// The FastSLAM filters that carry poses or landmarks by sigma points.
namespace montecarta::filters {

/// The option that includes the landmark's covariance in the innovation of the pose (EQUATIONS 7).
Parameter map_uncertainty_option();
MapUncertainty map_uncertainty(const FilterOptions& options);

/// Interval and weights of central differences (EQUATIONS 3) for every stage; `map_uncertainty`
/// only affects the pose.
std::vector<Parameter> central_difference_options();
SigmaPoints central_difference_points(const FilterSetup& setup, MapUncertainty map_uncertainty,
                                      NewLandmarks new_landmarks = NewLandmarks::corrected);
/// The scaled unscented transform of every stage (EQUATIONS 7), with 5 dimensions for a motion with
/// two controls (pose, control) and for an observation (pose, landmark), and 2 for a landmark.
SigmaPoints unscented_points(const FilterSetup& setup);

/// SRCD-aided FastSLAM (EQUATIONS 8): poses like FastSLAM II, landmarks by central differences.
template <class Real>
std::unique_ptr<SlamFilter> make_srcd_aided(const FilterSetup& setup) {
  return make_refined<Real>(setup, Linearised(),
                            central_difference_points(setup, MapUncertainty::on));
}
/// SRCD-particle-filter based FastSLAM (EQUATIONS 8): poses by central differences, landmarks like
/// FastSLAM II.
template <class Real>
std::unique_ptr<SlamFilter> make_srcd_pf(const FilterSetup& setup) {
  return make_refined<Real>(setup, central_difference_points(setup, map_uncertainty(setup.options)),
                            Linearised());
}

/// Makes the filter for the sensor of the setup, with `points` at every stage.
template <class Real>
std::unique_ptr<SlamFilter> make_refined_of_sensor(const FilterSetup& setup,
                                                   const SigmaPoints& points) {
  return with_sensor(setup.belief.sensor, [&](const auto& sensor_policy) {
    return make_refined<Real, std::decay_t<decltype(sensor_policy)>>(setup, points, points);
  });
}

// These large templates are compiled apart. The last two serve SRCD-FastSLAM and U-FastSLAM.
extern template std::unique_ptr<SlamFilter> make_srcd_aided<Lanes>(const FilterSetup&);
extern template std::unique_ptr<SlamFilter> make_srcd_pf<Lanes>(const FilterSetup&);
extern template std::unique_ptr<SlamFilter> make_refined<Lanes>(const FilterSetup&,
                                                                const SigmaPoints&,
                                                                const SigmaPoints&);
extern template std::unique_ptr<SlamFilter> make_refined_of_sensor<Lanes>(const FilterSetup&,
                                                                          const SigmaPoints&);

/// Unscented FastSLAM (Kim 2008): FastSLAM II with the unscented transform at every stage.
FilterKind ufastslam_kind();
/// SRCD-FastSLAM (Ankishan 2016; EQUATIONS 8): FastSLAM II with central differences at every stage.
/// It keeps covariances and factors them when points are drawn, which equals the square-root
/// recursion up to rounding.
FilterKind srcd_kind();
FilterKind srcd_aided_kind();
FilterKind srcd_pf_kind();

}  // namespace montecarta::filters
