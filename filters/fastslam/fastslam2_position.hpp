// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/fast_slam_filters.hpp"
#include "filters/moments/linearised_position.hpp"

namespace montecarta::filters {

/// FastSLAM II of a sensor that measures positions. Identities must be known.
template <class Real>
std::unique_ptr<SlamFilter> make_fastslam2_position(const FilterSetup& setup) {
  expect(setup.association.kind == Association::known, "FastSLAM of positions knows identities");
  using Known = KnownAssociation<Real>;
  using Proposal = GaussianProposal<Real, LinearisedPosition, LinearisedPosition>;
  const PopulationSettings settings = population_settings(setup.options);
  Belief belief = setup.belief;  // (forward, left) in the places of (range, bearing)
  belief.sigma_range = belief.sigma_forward;
  belief.sigma_bearing = belief.sigma_left;
  return std::make_unique<FastSlam<Real, Proposal, Known>>(
      settings, Proposal(settings.particles, belief, weight_form(setup.options), {}, {}),
      Known(setup.landmarks));
}

extern template std::unique_ptr<SlamFilter> make_fastslam2_position<Lanes>(const FilterSetup&);

}  // namespace montecarta::filters
