// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/fast_slam.hpp"
#include "filters/fastslam/gaussian_proposal.hpp"
#include "filters/fastslam/known_association.hpp"
#include "filters/fastslam/nearest_association.hpp"

#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

namespace montecarta::filters {

// A file that makes FastSLAM I, or a filter for a sensor that does not fix landmarks, includes
// their headers.
template <class Real, KeepsLandmarks<Real> MapTransform>
class MotionSampling;
template <class Real>
class DelayedKnownAssociation;

struct FilterKind;

/// Makes FastSLAM with the given proposal and the association of the setup. `SensorPolicy` is
/// SensorAtPose or OnMounting, according to the sensor of the setup.
template <class Real, class SensorPolicy = SensorAtPose, class Proposal>
std::unique_ptr<SlamFilter> make_fast_slam(const FilterSetup& setup,
                                           const PopulationSettings& settings, Proposal proposal) {
  const auto with = [&](auto association) -> std::unique_ptr<SlamFilter> {
    return std::make_unique<FastSlam<Real, Proposal, decltype(association)>>(
        settings, setup.belief, std::move(proposal), std::move(association));
  };
  const bool is_known = setup.association.kind == Association::known;
  if constexpr (FixesLandmark<typename SensorPolicy::Kind>) {
    using Held = typename Proposal::Landmark;
    if (is_known) return with(KnownAssociation<Real, Held>(setup.landmarks));
    return with(NearestAssociation<Real, SensorPolicy, Held>(settings.particles, setup.association,
                                                             setup.belief));
  } else {
    expect(is_known, "delayed initialisation knows identities");
    return with(DelayedKnownAssociation<Real>(setup.landmarks, settings.particles, setup.belief));
  }
}

/// Reads the option `weights`.
WeightForm weight_form(const FilterOptions& options);

/// Makes FastSLAM with poses that are refined by the scan. Each Gaussian has its own transform,
/// given as that of range and bearing.
template <class Real, class SensorPolicy = SensorAtPose, class PoseTransform, class MapTransform>
std::unique_ptr<SlamFilter> make_refined(const FilterSetup& setup,
                                         const PoseTransform& pose_transform,
                                         const MapTransform& map_transform) {
  const PopulationSettings settings = population_settings(setup.options);
  const SensorPolicy sensor_policy(setup.belief.sensor);
  const auto for_pose = sensor_policy.transform(pose_transform);
  const auto for_map = sensor_policy.transform(map_transform);
  using Proposal =
      GaussianProposal<Real, std::decay_t<decltype(for_pose)>, std::decay_t<decltype(for_map)>>;
  return make_fast_slam<Real, SensorPolicy>(
      setup, settings,
      Proposal(settings.particles, setup.belief, weight_form(setup.options), for_pose, for_map));
}

/// With `Real` = double this is the same filter, one particle at a time, for tests.
template <class Real, class SensorPolicy = SensorAtPose>
std::unique_ptr<SlamFilter> make_fastslam1(const FilterSetup& setup) {
  const auto transform = SensorPolicy(setup.belief.sensor).transform(Linearised());
  return make_fast_slam<Real, SensorPolicy>(
      setup, population_settings(setup.options),
      MotionSampling<Real, std::decay_t<decltype(transform)>>(setup.belief, transform));
}
template <class Real, class SensorPolicy = SensorAtPose>
std::unique_ptr<SlamFilter> make_fastslam2(const FilterSetup& setup) {
  return make_refined<Real, SensorPolicy>(setup, Linearised(), Linearised());
}

/// These functions make the filter for the sensor of the setup.
template <class Real>
std::unique_ptr<SlamFilter> make_fastslam1_of_sensor(const FilterSetup& setup) {
  return with_sensor(setup.belief.sensor, [&](const auto& sensor_policy) {
    return make_fastslam1<Real, std::decay_t<decltype(sensor_policy)>>(setup);
  });
}
template <class Real>
std::unique_ptr<SlamFilter> make_fastslam2_of_sensor(const FilterSetup& setup) {
  return with_sensor(setup.belief.sensor, [&](const auto& sensor_policy) {
    return make_fastslam2<Real, std::decay_t<decltype(sensor_policy)>>(setup);
  });
}

// These large templates are compiled apart.
extern template std::unique_ptr<SlamFilter> make_fastslam1<Lanes>(const FilterSetup&);
extern template std::unique_ptr<SlamFilter> make_fastslam2<Lanes>(const FilterSetup&);
extern template std::unique_ptr<SlamFilter> make_fastslam1_of_sensor<Lanes>(const FilterSetup&);
extern template std::unique_ptr<SlamFilter> make_fastslam2_of_sensor<Lanes>(const FilterSetup&);

/// The kind of FastSLAM II and the filters like it, for range and bearing at the pose.
FilterKind refined_kind(const char* name, const char* long_name, const char* source,
                        std::vector<Parameter> options,
                        std::unique_ptr<SlamFilter> make(const FilterSetup&));
/// Returns `kind` with support for all sensors, mounted anywhere.
FilterKind of_all_sensors(FilterKind kind);

FilterKind fastslam1_kind();
FilterKind fastslam2_kind();

}  // namespace montecarta::filters
