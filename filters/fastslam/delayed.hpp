// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/delayed_proposal.hpp"
#include "filters/fastslam/fast_slam_filters.hpp"
#include "filters/fastslam/sigma_point_options.hpp"

namespace montecarta {

/// The options of delayed filters, behind the family's; `landmarks` among them.
std::vector<FilterOption> delayed_options();
DrawTimes draw_times(const FilterOptions& options);

template <class Real, class PoseTransform, class MapTransform>
std::unique_ptr<SlamFilter> make_delaying(const FilterSetup& setup, const PoseTransform& poses,
                                          const MapTransform& map) {
  const FastSlamSettings settings = fast_slam_settings(setup.options);
  return make_fast_slam<Real>(
      setup, settings,
      DelayedProposal<Real, PoseTransform, MapTransform>(settings.particles, setup.belief,
                                                         draw_times(setup.options), poses, map));
}

/// FastSLAM II with delayed draws (SPEC 24, last lines).
template <class Real>
std::unique_ptr<SlamFilter> make_delayed(const FilterSetup& setup) {
  return make_delaying<Real>(setup, Linearised(), Linearised());
}
inline SigmaPoints delayed_srcd_points(const FilterSetup& setup) {
  return central_difference_points(setup, MapUncertainty::on);
}
/// The same by central differences: SRCD-FastSLAM where every scan draws.
template <class Real>
std::unique_ptr<SlamFilter> make_delayed_srcd(const FilterSetup& setup) {
  const SigmaPoints points = delayed_srcd_points(setup);
  return make_delaying<Real>(setup, points, points);
}

// With anchored landmarks; each compiled apart.
extern template std::unique_ptr<SlamFilter> make_delaying<Lanes>(const FilterSetup&,
                                                                 const Linearised&,
                                                                 const Anchored&);
extern template std::unique_ptr<SlamFilter> make_delaying<Lanes>(const FilterSetup&,
                                                                 const SigmaPoints&,
                                                                 const Anchored&);

FilterKind delayed_kind();
FilterKind delayed_srcd_kind();

}  // namespace montecarta
