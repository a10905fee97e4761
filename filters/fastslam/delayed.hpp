// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/delayed_proposal.hpp"
#include "filters/fastslam/fast_slam_filters.hpp"

namespace montecarta::filters {

DrawTimes draw_times(const FilterOptions& options);

/// FastSLAM II with delayed draws (EQUATIONS 11).
template <class Real>
std::unique_ptr<SlamFilter> make_delayed(const FilterSetup& setup) {
  const PopulationSettings settings = population_settings(setup.options);
  return make_fast_slam<Real>(
      setup, settings,
      DelayedProposal<Real>(settings.particles, setup.belief, draw_times(setup.options)));
}

}  // namespace montecarta::filters
