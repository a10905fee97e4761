// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/joint_filter.hpp"

#include "filters/joint/joint_belief.hpp"
#include "filters/moments/control_motion.hpp"
#include "filters/population/population.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

namespace montecarta::filters {
namespace {

/// The settings in which the filters with one joint Gaussian differ.
struct JointFilterSettings {
  Retraction retraction = Retraction::additive;
  int iterations = 0;  ///< number of linearisations after the first
  Motion motion = Motion::linearised;
  Moments moments = Moments::map;  ///< moments that the filter reports
  std::unique_ptr<Linearisation> linearisation = at_estimate();
};

/// A filter with one Gaussian over pose and map: EKF-SLAM and its variants (EQUATIONS 15).
class JointFilter final : public SlamFilter {
 public:
  JointFilter(const FilterSetup& setup, JointFilterSettings settings)
      : belief_(setup.belief),
        motion_form_(settings.motion),
        joint_(setup, settings.retraction, settings.iterations, settings.moments,
               std::move(settings.linearisation)) {}

  void start(const Pose& start) override { start_with({.pose = {start}}); }
  void start_from(const StepContext& /*context*/, const Prior& prior) override {
    start_with(prior);
  }
  void predict(const StepContext& /*context*/, const Control& control, double duration) override {
    is_at_scan_ = false;
    advance(motion_, control, duration, belief_, motion_form_);
  }

  void take_fix(const PositionFix& fix) override { fix_ = fix; }

  /// Throws std::runtime_error if the likelihood of the scan is not finite.
  void update(const StepContext& context, Scan scan) override {
    joint_.update_with(motion_, scan, std::exchange(fix_, std::nullopt));
    motion_.restart();
    report_update(context, scan);
    is_at_scan_ = true;
    pose_at_scan_ = joint_.pose_after(motion_);
    joint_.initialise_landmarks(scan);
    report_.map_size = static_cast<double>(joint_.landmarks());
  }

  PoseEstimate estimate() const override {
    return {is_at_scan_ ? pose_at_scan_ : joint_.pose_after(motion_), std::nullopt};
  }
  const ScanReport& report() const override { return report_; }
  void map(std::span<std::optional<LandmarkEstimate>> landmarks) const override {
    for (std::size_t k = 0; k < landmarks.size(); ++k) landmarks[k] = joint_.landmark(k);
  }
  std::optional<JointEstimate> joint(std::size_t landmarks) const override {
    return joint_.joint(landmarks);
  }

 private:
  void start_with(const Prior& prior) {
    motion_.restart();
    fix_.reset();
    joint_.start(prior);
    is_at_scan_ = false;
    report_ = {};
  }
  void report_update(const StepContext& context, Scan scan) {
    const auto& [log_likelihood, faults] = joint_.outcome();
    if (!std::isfinite(log_likelihood))
      throw std::runtime_error("the log-likelihood of the scan is not finite");
    report_ = {.log_likelihood = log_likelihood,
               .numerical_faults = faults,
               .association = joint_.association().counts(),
               .own = joint_.rotation_information()};
    innovations_.start(context, 1, scan.size(), 0.0);
    const auto innovations = innovations_.of_block(0, 1.0);
    for (const auto& [k, v, S] : joint_.used_detections()) {
      innovations.add(k, {{v(0), v(1)}, {S(0, 0), S(1, 0), S(1, 1)}}, AllLanes());
      innovations_.matched_weight(k) = 1.0;
    }
    innovations_.add_to(context, report_, components_of(belief_.sensor).size());
  }

  Belief belief_;
  Motion motion_form_;
  JointBelief joint_;
  MotionIncrement motion_;          ///< motion since the last scan
  std::optional<PositionFix> fix_;  ///< fix for the next scan
  bool is_at_scan_ = false;
  PoseMoments pose_at_scan_;  ///< moments at the last scan, before landmarks were initialised
  ScanReport report_;
  MixtureInnovations<double> innovations_;  ///< innovations of a mixture of one
};

Parameter iterations_option() {
  return count_parameter(
      "iterations", "0", 0, 100,
      "number of times that a detection is linearised again at the updated estimate");
}

std::unique_ptr<SlamFilter> one_gaussian(const FilterSetup& setup, Retraction retraction) {
  const auto iterations = static_cast<int>(setup.options.integer("iterations"));
  return std::make_unique<JointFilter>(setup,
                                       JointFilterSettings{.retraction = retraction,
                                                           .iterations = iterations,
                                                           .motion = motion_of(setup.options),
                                                           .moments = moments_of(setup.options)});
}

/// Makes EKF-SLAM that linearises at other points than the estimate.
template <std::unique_ptr<Linearisation> kLinearisation()>
std::unique_ptr<SlamFilter> linearised_elsewhere(const FilterSetup& setup) {
  return std::make_unique<JointFilter>(setup,
                                       JointFilterSettings{.motion = motion_of(setup.options),
                                                           .moments = moments_of(setup.options),
                                                           .linearisation = kLinearisation()});
}

/// Makes an unscented filter with one of the errors.
template <Retraction kRetraction>
std::unique_ptr<SlamFilter> make_ukf(const FilterSetup& setup) {
  return std::make_unique<JointFilter>(setup,
                                       JointFilterSettings{.retraction = kRetraction,
                                                           .motion = motion_of(setup.options),
                                                           .moments = moments_of(setup.options),
                                                           .linearisation = by_sigma_points()});
}

std::unique_ptr<SlamFilter> make_robocentric(const FilterSetup& setup) {
  return std::make_unique<JointFilter>(setup,
                                       JointFilterSettings{.motion = motion_of(setup.options),
                                                           .linearisation = relative_to_vehicle()});
}

OwnColumn rotation_information_column() {
  return {"rotation_information", "observability", "rad-2",
          "information about the heading of the whole that detections since the start are taken "
          "for"};
}

FilterKind joint_kind(const char* name, const char* long_name, const char* source,
                      std::vector<Parameter> options,
                      std::unique_ptr<SlamFilter> make(const FilterSetup&)) {
  return {.name = name,
          .long_name = long_name,
          .source = source,
          .reports = {.joint = true, .own_columns = {rotation_information_column()}},
          .options = std::move(options),
          .sensors = {RangeBearingSensor::kName, PositionSensor::kName},
          .restrict_reports =
              [](const FilterSetup& setup, Capabilities& reports) {
                if (has_rotation_information(setup)) return;
                std::erase_if(reports.own_columns, [](const OwnColumn& column) {
                  return column.name == rotation_information_column().name;
                });
              },
          .make = make};
}

/// Makes a filter kind that supports all sensors.
FilterKind one_gaussian_kind(const char* name, const char* long_name, const char* source,
                             std::unique_ptr<SlamFilter> make(const FilterSetup&)) {
  FilterKind kind =
      joint_kind(name, long_name, source,
                 {iterations_option(), linearised_motion_option(), moments_option("map")}, make);
  kind.sensors.clear();
  kind.delays_initialisation = kind.takes_prior = kind.takes_fixes = true;
  return kind;
}

FilterKind unscented_kind(const char* name, const char* long_name, const char* source,
                          std::unique_ptr<SlamFilter> make(const FilterSetup&)) {
  FilterKind kind =
      joint_kind(name, long_name, source, {fitting_motion_option(), moments_option("map")}, make);
  kind.takes_prior = kind.takes_fixes = true;
  return kind;
}

}  // namespace

std::unique_ptr<SlamFilter> make_ekf_slam(const FilterSetup& setup) {
  return one_gaussian(setup, Retraction::additive);
}

std::unique_ptr<SlamFilter> make_riekf_slam(const FilterSetup& setup) {
  return one_gaussian(setup, Retraction::right_invariant);
}

FilterKind ekf_slam_kind() {
  return one_gaussian_kind("ekf_slam", "EKF-SLAM", "Smith, Self, Cheeseman 1990; EQUATIONS 15",
                           make_ekf_slam);
}

FilterKind riekf_slam_kind() {
  return one_gaussian_kind("riekf_slam", "right-invariant EKF-SLAM", "Barrau, Bonnabel 2015",
                           make_riekf_slam);
}

FilterKind fej_ekf_slam_kind() {
  return joint_kind("fej_ekf_slam", "first-estimates Jacobian EKF-SLAM",
                    "Huang, Mourikis, Roumeliotis 2008",
                    {linearised_motion_option(), moments_option("map")},
                    linearised_elsewhere<at_first_estimates>);
}

FilterKind oc_ekf_slam_kind() {
  return joint_kind("oc_ekf_slam", "observability-constrained EKF-SLAM",
                    "Huang, Mourikis, Roumeliotis 2010",
                    {linearised_motion_option(), moments_option("map")},
                    linearised_elsewhere<at_constrained_estimates>);
}

FilterKind ukf_slam_kind() {
  return unscented_kind("ukf_slam", "unscented Kalman filter SLAM",
                        "Huang, Mourikis, Roumeliotis 2009", make_ukf<Retraction::additive>);
}

FilterKind right_ukf_slam_kind() {
  return unscented_kind("right_ukf_slam", "right-invariant unscented Kalman filter SLAM",
                        "Brossard, Barrau, Bonnabel 2020", make_ukf<Retraction::right_invariant>);
}

FilterKind left_ukf_slam_kind() {
  return unscented_kind("left_ukf_slam", "left-invariant unscented Kalman filter SLAM",
                        "Brossard, Barrau, Bonnabel 2020", make_ukf<Retraction::left_invariant>);
}

FilterKind robocentric_ekf_slam_kind() {
  return joint_kind("robocentric_ekf_slam", "robocentric EKF-SLAM",
                    "Castellanos, Martinez-Cantin, Tardos, Neira 2007",
                    {linearised_motion_option()}, make_robocentric);
}

}  // namespace montecarta::filters
