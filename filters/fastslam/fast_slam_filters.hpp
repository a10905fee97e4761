// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/fast_slam.hpp"
#include "filters/fastslam/gaussian_proposal.hpp"
#include "filters/fastslam/known_association.hpp"
#include "filters/fastslam/motion_sampling.hpp"
#include "filters/fastslam/nearest_association.hpp"
#include "filters/fastslam/seen_by.hpp"

#include <memory>
#include <utility>

namespace montecarta::filters {

/// FastSLAM with a proposal of the caller's making; the association is the setup's. `SeenBy`:
/// AtPose or OnMounting, as the setup's sensor is.
template <class Real, class SeenBy = AtPose, class Proposal>
std::unique_ptr<SlamFilter> make_fast_slam(const FilterSetup& setup,
                                           const PopulationSettings& settings, Proposal proposal) {
  const auto with = [&](auto association) -> std::unique_ptr<SlamFilter> {
    return std::make_unique<FastSlam<Real, Proposal, decltype(association)>>(
        settings, components_of(setup.belief.sensor).size(), std::move(proposal),
        std::move(association));
  };
  const bool is_known = setup.association.kind == Association::known;
  if constexpr (FixesLandmark<typename SeenBy::Kind>) {
    using Held = typename Proposal::Landmark;
    if (is_known) return with(KnownAssociation<Real, Held>(setup.landmarks));
    return with(NearestAssociation<Real, SeenBy, Held>(settings.particles, setup.association,
                                                       setup.belief));
  } else {
    expect(is_known, "delayed initialisation knows identities");
    return with(DelayedKnownAssociation<Real>(setup.landmarks, settings.particles, setup.belief));
  }
}

/// Reads the option `weights`.
WeightForm weight_form(const FilterOptions& options);
/// Whether the option `weights` is `ratio`, which leaves no mixture (FilterKind::drops_mixture).
bool weighs_by_ratio(const FilterOptions& options);

/// FastSLAM whose poses are refined by the scan, each Gaussian carried by a transform of its own,
/// given as that of range and bearing.
template <class Real, class SeenBy = AtPose, class PoseTransform, class MapTransform>
std::unique_ptr<SlamFilter> make_refined(const FilterSetup& setup,
                                         const PoseTransform& pose_transform,
                                         const MapTransform& map_transform) {
  const PopulationSettings settings = population_settings(setup.options);
  const SeenBy seen_by(setup.belief.sensor);
  const auto for_pose = seen_by.transform(pose_transform);
  const auto for_map = seen_by.transform(map_transform);
  using Proposal =
      GaussianProposal<Real, std::decay_t<decltype(for_pose)>, std::decay_t<decltype(for_map)>>;
  return make_fast_slam<Real, SeenBy>(
      setup, settings,
      Proposal(settings.particles, setup.belief, weight_form(setup.options), for_pose, for_map));
}

/// Whether the landmark's covariance is part of the pose's innovation (EQUATIONS 7).
Parameter map_uncertainty_option();
MapUncertainty map_uncertainty(const FilterOptions& options);

/// Interval and weights of central differences (EQUATIONS 3), for every stage; `map_uncertainty`
/// matters to the pose alone.
std::vector<Parameter> central_difference_options();
SigmaPoints central_difference_points(const FilterSetup& setup, MapUncertainty map_uncertainty);
/// The scaled unscented transform of every stage (EQUATIONS 7): dimension 5 for motion (pose,
/// control) and for an observation (pose, landmark), 2 for a landmark.
SigmaPoints unscented_points(const FilterSetup& setup);

/// `Real` = double is the same filter one particle at a time, for tests.
template <class Real, class SeenBy = AtPose>
std::unique_ptr<SlamFilter> make_fastslam1(const FilterSetup& setup) {
  const auto transform = SeenBy(setup.belief.sensor).transform(Linearised());
  return make_fast_slam<Real, SeenBy>(
      setup, population_settings(setup.options),
      MotionSampling<Real, std::decay_t<decltype(transform)>>(setup.belief, transform));
}
template <class Real, class SeenBy = AtPose>
std::unique_ptr<SlamFilter> make_fastslam2(const FilterSetup& setup) {
  return make_refined<Real, SeenBy>(setup, Linearised(), Linearised());
}
/// Unscented FastSLAM (Kim 2008): FastSLAM II with every Gaussian carried by the unscented
/// transform.
template <class Real, class SeenBy = AtPose>
std::unique_ptr<SlamFilter> make_ufastslam(const FilterSetup& setup) {
  const SigmaPoints unscented = unscented_points(setup);
  return make_refined<Real, SeenBy>(setup, unscented, unscented);
}
/// SRCD-FastSLAM (Ankishan 2016; EQUATIONS 8): FastSLAM II with every Gaussian carried by central
/// differences. Covariances are kept, and the factor is taken where points are drawn: the same
/// numbers as the square-root recursion, to rounding.
template <class Real, class SeenBy = AtPose>
std::unique_ptr<SlamFilter> make_srcd(const FilterSetup& setup) {
  const SigmaPoints points = central_difference_points(setup, map_uncertainty(setup.options));
  return make_refined<Real, SeenBy>(setup, points, points);
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
  return make_refined<Real>(setup, central_difference_points(setup, map_uncertainty(setup.options)),
                            Linearised());
}

// Compiled apart: the templates are large, and both SRCD-FastSLAM and U-FastSLAM are the last.
extern template std::unique_ptr<SlamFilter> make_fastslam1<Lanes>(const FilterSetup&);
extern template std::unique_ptr<SlamFilter> make_fastslam2<Lanes>(const FilterSetup&);
extern template std::unique_ptr<SlamFilter> make_srcd_aided<Lanes>(const FilterSetup&);
extern template std::unique_ptr<SlamFilter> make_srcd_pf<Lanes>(const FilterSetup&);
extern template std::unique_ptr<SlamFilter> make_refined<Lanes>(const FilterSetup&,
                                                                const SigmaPoints&,
                                                                const SigmaPoints&);

/// Of the setup's sensor, whichever it is.
std::unique_ptr<SlamFilter> make_fastslam1_of_sensor(const FilterSetup& setup);
std::unique_ptr<SlamFilter> make_fastslam2_of_sensor(const FilterSetup& setup);
std::unique_ptr<SlamFilter> make_refined_of_sensor(const FilterSetup& setup,
                                                   const SigmaPoints& points);

/// Lines for the table of factory.cpp.
FilterKind fastslam1_kind();
FilterKind fastslam2_kind();
FilterKind ufastslam_kind();
FilterKind srcd_kind();
FilterKind srcd_aided_kind();
FilterKind srcd_pf_kind();
FilterKind de_srcd_kind();

}  // namespace montecarta::filters
