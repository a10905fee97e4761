// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/joint_filters.hpp"

#include "filters/joint/gaussian_bank.hpp"
#include "filters/setup/filter_options.hpp"

namespace montecarta::filters {
namespace {

// In the order of the enumerators.
const std::vector<std::string> kErrors{"additive", "invariant"};

Option iterations_option(const char* fallback) {
  return count_option("iterations", fallback, 0, 100,
                      "times a detection is linearised again where it has moved the estimate to");
}

int iterations(const FilterOptions& options) {
  return static_cast<int>(options.integer("iterations"));
}

/// [rad]; nothing for 0.
std::optional<double> split_beyond(const FilterOptions& options) {
  const double degrees = options.number("split_beyond_deg");
  if (degrees == 0.0) return std::nullopt;
  return degrees * kPi / 180.0;
}

std::unique_ptr<SlamFilter> one_gaussian(const FilterSetup& setup, Retraction retraction) {
  return std::make_unique<GaussianBank>(setup, BankSettings{.retraction = retraction,
                                                            .iterations = iterations(setup.options),
                                                            .motion = motion_of(setup.options),
                                                            .moments = moments_of(setup.options)});
}

/// EKF-SLAM that linearises elsewhere than at the estimate.
template <Linearisation kLinearisation>
std::unique_ptr<SlamFilter> linearised_elsewhere(const FilterSetup& setup) {
  return std::make_unique<GaussianBank>(setup, BankSettings{.motion = motion_of(setup.options),
                                                            .moments = moments_of(setup.options),
                                                            .linearisation = kLinearisation});
}

std::unique_ptr<SlamFilter> make_robocentric(const FilterSetup& setup) {
  return std::make_unique<GaussianBank>(
      setup,
      BankSettings{.motion = motion_of(setup.options), .linearisation = Linearisation::relative});
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

std::unique_ptr<SlamFilter> make_hrb(const FilterSetup& setup) {
  const FilterOptions& options = setup.options;
  return std::make_unique<GaussianBank>(
      setup, BankSettings{.population = population_settings(options),
                          .retraction = chosen<Retraction>(options.choice("error"), kErrors),
                          .split_beyond = split_beyond(options),
                          .keep = options.number("keep"),
                          .iterations = iterations(options),
                          .motion = motion_of(options),
                          .moments = moments_of(options),
                          .tells_particles = true});
}

FilterKind ekf_slam_kind() {
  return {.name = "ekf_slam",
          .long_name = "EKF-SLAM",
          .source = "Smith, Self, Cheeseman 1990; EQUATIONS 15",
          .has_particles = false,
          .has_mixture = false,
          .has_joint = true,
          .tells_rotation_information = true,
          .options = {iterations_option("0"), linearised_motion_option(), moments_option("map")},
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
          .options = {iterations_option("0"), linearised_motion_option(), moments_option("map")},
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

FilterKind hrb_kind() {
  std::vector<Option> options = population_options("30");
  options.insert(
      options.end(),
      {number_option("split_beyond_deg", "0", 0, 1e9,
                     "[degrees] a Gaussian that knows its heading worse than this draws it; 0: "
                     "where that bends "
                     "its map by more than the noise of a detection"),
       number_option("keep", "0.95", 0, 0.999,
                     "share of the heading's standard deviation that a draw leaves; 0: none"),
       choice_option("error", "invariant", kErrors,
                     "what the covariance is of: additive (EKF-SLAM) or invariant (RI-EKF-SLAM)"),
       iterations_option("5"), fitting_motion_option(), moments_option("map")});
  return {.name = "hrb",
          .long_name = "heading-split bank",
          .source = "EQUATIONS 16",
          .has_mixture = true,
          .has_joint = true,
          .options = std::move(options),
          .sensors = {},
          .delays_initialisation = true,
          .make = make_hrb};
}

}  // namespace montecarta::filters
