// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/evolved_proposal.hpp"
#include "filters/fastslam/fast_slam_filters.hpp"
#include "filters/fastslam/sigma_point_options.hpp"

namespace montecarta {

/// What evolution was told to be.
EvolvedSettings evolved_settings(const FilterOptions& options);

/// FastSLAM whose poses, by central differences, are moved by differential evolution.
template <class Real, class MapTransform>
std::unique_ptr<SlamFilter> make_evolved(const FilterSetup& setup, const SigmaPoints& poses,
                                         const MapTransform& map) {
  const FastSlamSettings settings = fast_slam_settings(setup.options);
  return make_fast_slam<Real>(
      setup, settings,
      EvolvedProposal<Real, MapTransform>(settings.particles, setup.belief,
                                          evolved_settings(setup.options), poses, map));
}

/// DE-SRCD-FastSLAM (Ankishan 2016; SPEC 13): SRCD-FastSLAM with its poses moved by differential
/// evolution.
template <class Real>
std::unique_ptr<SlamFilter> make_de_srcd(const FilterSetup& setup) {
  const SigmaPoints points = central_difference_points(setup, map_uncertainty(setup.options));
  return make_evolved<Real>(setup, points, points);
}
/// The same with anchored landmarks (SPEC 24, last lines).
template <class Real>
std::unique_ptr<SlamFilter> make_de_srcd_anchored(const FilterSetup& setup) {
  return make_evolved<Real>(setup, central_difference_points(setup, map_uncertainty(setup.options)),
                            Anchored());
}

// Compiled apart.
extern template std::unique_ptr<SlamFilter> make_de_srcd_anchored<Lanes>(const FilterSetup&);

}  // namespace montecarta
