// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/evolved_proposal.hpp"
#include "filters/fastslam/fast_slam_filters.hpp"

namespace montecarta::filters {

/// What evolution was told to be.
EvolvedSettings evolved_settings(const FilterOptions& options);

/// DE-SRCD-FastSLAM (Ankishan 2016; EQUATIONS 10): SRCD-FastSLAM with its poses moved by
/// differential evolution.
template <class Real>
std::unique_ptr<SlamFilter> make_de_srcd(const FilterSetup& setup) {
  const PopulationSettings settings = population_settings(setup.options);
  return make_fast_slam<Real>(
      setup, settings,
      EvolvedProposal<Real>(settings.particles, setup.belief, evolved_settings(setup.options),
                            central_difference_points(setup, map_uncertainty(setup.options))));
}

}  // namespace montecarta::filters
