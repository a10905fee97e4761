// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/anchored.hpp"
#include "filters/fastslam/fast_slam_filters.hpp"
#include "filters/fastslam/moved_proposal.hpp"

namespace montecarta {

/// The option `move_lag` of filters whose particles can part again after a resampling.
FilterOption move_lag_option();
std::size_t move_lag(const FilterOptions& options);
/// Throws a StudyError where poses are to be moved and the setup asks for more than known
/// association and landmarks in the map.
void check_move(const FilterSetup& setup);

/// FastSLAM II or its sigma-point kin that moves its poses of the last `move_lag` scans.
template <class Real, class Transform>
std::unique_ptr<SlamFilter> make_moved(const FilterSetup& setup, const Transform& transform) {
  check_move(setup);
  using Proposal = MovedProposal<Real, Transform, Transform>;
  using Known = KnownAssociation<Real>;
  const FastSlamSettings settings = fast_slam_settings(setup.options);
  return std::make_unique<FastSlam<Real, Proposal, Known>>(
      settings,
      Proposal(settings.particles, setup.belief, weight_form(setup.options), transform, transform,
               move_lag(setup.options)),
      Known(setup.landmarks));
}

// Each compiled apart.
extern template std::unique_ptr<SlamFilter> make_moved<Lanes>(const FilterSetup&,
                                                              const Linearised&);
extern template std::unique_ptr<SlamFilter> make_moved<Lanes>(const FilterSetup&,
                                                              const SigmaPoints&);

/// As make_anchored_or(), but poses are moved where the option `move_lag` asks for it.
template <class PoseTransform, class Plain>
std::unique_ptr<SlamFilter> make_as_chosen(const FilterSetup& setup, const PoseTransform& poses,
                                           const Plain& plain) {
  if (move_lag(setup.options) > 0) return make_moved<Lanes>(setup, poses);
  return make_anchored_or(setup, poses, plain);
}

}  // namespace montecarta
