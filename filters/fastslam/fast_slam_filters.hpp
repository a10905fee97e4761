// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/fast_slam.hpp"
#include "filters/fastslam/fast_slam_options.hpp"
#include "filters/fastslam/gaussian_proposal.hpp"
#include "filters/fastslam/known_association.hpp"
#include "filters/fastslam/motion_sampling.hpp"
#include "filters/fastslam/nearest_association.hpp"
#include "filters/moments/moment_transforms.hpp"
#include "filters/setup/filter_setup.hpp"

#include <memory>
#include <utility>

namespace montecarta {

/// FastSLAM with a proposal of the caller's making; the association is the setup's.
template <class Real, class Proposal>
std::unique_ptr<SlamFilter> make_fast_slam(const FilterSetup& setup,
                                           const PopulationSettings& settings, Proposal proposal) {
  if (setup.association.kind == Association::known) {
    using Known = KnownAssociation<Real>;
    return std::make_unique<FastSlam<Real, Proposal, Known>>(settings, std::move(proposal),
                                                             Known(setup.landmarks));
  }
  using Nearest = NearestAssociation<Real>;
  return std::make_unique<FastSlam<Real, Proposal, Nearest>>(
      settings, std::move(proposal), Nearest(settings.particles, setup.association, setup.belief));
}

/// FastSLAM whose poses are refined by the scan, each Gaussian carried by a transform of its own.
template <class Real, class PoseTransform, class MapTransform>
std::unique_ptr<SlamFilter> make_refined(const FilterSetup& setup,
                                         const PoseTransform& pose_transform,
                                         const MapTransform& map_transform) {
  const PopulationSettings settings = population_settings(setup.options);
  return make_fast_slam<Real>(setup, settings,
                              GaussianProposal<Real, PoseTransform, MapTransform>(
                                  settings.particles, setup.belief, weight_form(setup.options),
                                  pose_transform, map_transform));
}

// Compiled apart: both SRCD-FastSLAM and U-FastSLAM are it.
extern template std::unique_ptr<SlamFilter> make_refined<Lanes>(const FilterSetup&,
                                                                const SigmaPoints&,
                                                                const SigmaPoints&);

/// `Real` = double is the same filter one particle at a time, for tests.
template <class Real>
std::unique_ptr<SlamFilter> make_fastslam1(const FilterSetup& setup) {
  return make_fast_slam<Real>(setup, population_settings(setup.options),
                              MotionSampling<Real>(setup.belief));
}
template <class Real>
std::unique_ptr<SlamFilter> make_fastslam2(const FilterSetup& setup) {
  return make_refined<Real>(setup, Linearised(), Linearised());
}

/// Lines for the table of factory.cpp.
FilterKind fastslam1_kind();
FilterKind fastslam2_kind();
FilterKind ufastslam_kind();
FilterKind srcd_kind();
FilterKind srcd_aided_kind();
FilterKind srcd_pf_kind();
FilterKind de_srcd_kind();

}  // namespace montecarta
