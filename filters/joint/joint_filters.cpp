// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/joint_filters.hpp"

#include "filters/joint/joint_filter.hpp"
#include "filters/setup/filter_options.hpp"

namespace montecarta::filters {
namespace {

Option iterations_option() {
  return count_option("iterations", "0", 0, 100,
                      "times a detection is linearised again where it has moved the estimate to");
}

int iterations(const FilterOptions& options) {
  return static_cast<int>(options.integer("iterations"));
}

std::unique_ptr<SlamFilter> one_gaussian(const FilterSetup& setup, Retraction retraction) {
  return std::make_unique<JointFilter>(setup,
                                       JointFilterSettings{.retraction = retraction,
                                                           .iterations = iterations(setup.options),
                                                           .motion = motion_of(setup.options),
                                                           .moments = moments_of(setup.options)});
}

/// EKF-SLAM that linearises elsewhere than at the estimate.
template <Linearisation kLinearisation>
std::unique_ptr<SlamFilter> linearised_elsewhere(const FilterSetup& setup) {
  return std::make_unique<JointFilter>(setup,
                                       JointFilterSettings{.motion = motion_of(setup.options),
                                                           .moments = moments_of(setup.options),
                                                           .linearisation = kLinearisation});
}

std::unique_ptr<SlamFilter> make_robocentric(const FilterSetup& setup) {
  return std::make_unique<JointFilter>(
      setup, JointFilterSettings{.motion = motion_of(setup.options),
                                 .linearisation = Linearisation::relative});
}

template <Linearisation kLinearisation>
FilterKind linearised_elsewhere_kind(const char* name, const char* long_name, const char* source,
                                     Option motion) {
  return {.name = name,
          .long_name = long_name,
          .source = source,
          .has_particles = false,
          .has_mixture = false,
          .has_joint = true,
          .tells_rotation_information = true,
          .options = {std::move(motion), moments_option("map")},
          .sensors = {RangeBearingSensor::kName, PositionSensor::kName},
          .make = linearised_elsewhere<kLinearisation>};
}

}  // namespace

std::unique_ptr<SlamFilter> make_ekf_slam(const FilterSetup& setup) {
  return one_gaussian(setup, Retraction::additive);
}

std::unique_ptr<SlamFilter> make_riekf_slam(const FilterSetup& setup) {
  return one_gaussian(setup, Retraction::invariant);
}

FilterKind ekf_slam_kind() {
  return {.name = "ekf_slam",
          .long_name = "EKF-SLAM",
          .source = "Smith, Self, Cheeseman 1990; EQUATIONS 15",
          .has_particles = false,
          .has_mixture = false,
          .has_joint = true,
          .tells_rotation_information = true,
          .options = {iterations_option(), linearised_motion_option(), moments_option("map")},
          .sensors = {},
          .delays_initialisation = true,
          .make = make_ekf_slam};
}

FilterKind riekf_slam_kind() {
  return {.name = "riekf_slam",
          .long_name = "right-invariant EKF-SLAM",
          .source = "Barrau, Bonnabel 2015",
          .has_particles = false,
          .has_mixture = false,
          .has_joint = true,
          .tells_rotation_information = true,
          .options = {iterations_option(), linearised_motion_option(), moments_option("map")},
          .sensors = {},
          .delays_initialisation = true,
          .make = make_riekf_slam};
}

FilterKind fej_ekf_slam_kind() {
  return linearised_elsewhere_kind<Linearisation::first>(
      "fej_ekf_slam", "first-estimates Jacobian EKF-SLAM", "Huang, Mourikis, Roumeliotis 2008",
      linearised_motion_option());
}

FilterKind oc_ekf_slam_kind() {
  return linearised_elsewhere_kind<Linearisation::constrained>(
      "oc_ekf_slam", "observability-constrained EKF-SLAM", "Huang, Mourikis, Roumeliotis 2010",
      linearised_motion_option());
}

FilterKind ukf_slam_kind() {
  return linearised_elsewhere_kind<Linearisation::regression>(
      "ukf_slam", "unscented Kalman filter SLAM", "Huang, Mourikis, Roumeliotis 2009",
      fitting_motion_option());
}

FilterKind robocentric_ekf_slam_kind() {
  return {.name = "robocentric_ekf_slam",
          .long_name = "robocentric EKF-SLAM",
          .source = "Castellanos, Martinez-Cantin, Tardos, Neira 2007",
          .has_particles = false,
          .has_mixture = false,
          .has_joint = true,
          .tells_rotation_information = true,
          .options = {linearised_motion_option()},
          .sensors = {RangeBearingSensor::kName, PositionSensor::kName},
          .make = make_robocentric};
}

}  // namespace montecarta::filters
