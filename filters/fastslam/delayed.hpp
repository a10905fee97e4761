// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/delayed_proposal.hpp"
#include "filters/fastslam/fast_slam_filters.hpp"
#include "filters/fastslam/sigma_point_options.hpp"

namespace montecarta {

/// The options of delayed filters, behind the family's.
std::vector<FilterOption> delayed_options();
DrawTimes draw_times(const FilterOptions& options);

template <class Real, class Transform>
std::unique_ptr<SlamFilter> make_delaying(const FilterSetup& setup, const Transform& transform) {
  const FastSlamSettings settings = fast_slam_settings(setup.options);
  return make_fast_slam<Real>(
      setup, settings,
      DelayedProposal<Real, Transform>(settings.particles, setup.belief, draw_times(setup.options),
                                       transform));
}

/// FastSLAM II with delayed draws (SPEC 24, last lines).
template <class Real>
std::unique_ptr<SlamFilter> make_delayed(const FilterSetup& setup) {
  return make_delaying<Real>(setup, Linearised());
}
/// The same by central differences: SRCD-FastSLAM where every scan draws.
template <class Real>
std::unique_ptr<SlamFilter> make_delayed_srcd(const FilterSetup& setup) {
  return make_delaying<Real>(setup, central_difference_points(setup, MapUncertainty::on));
}

FilterKind delayed_kind();
FilterKind delayed_srcd_kind();

}  // namespace montecarta
