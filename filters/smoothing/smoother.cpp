// SPDX-License-Identifier: BSD-3-Clause
#include "filters/smoothing/smoother.hpp"

#include "filters/joint/joint_belief.hpp"
#include "filters/moments/control_motion.hpp"
#include "filters/smoothing/pose_window.hpp"
#include "filters/smoothing/relative_laplace.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace montecarta::filters {
namespace {

/// A solution has converged if a step is less than a tenth of a standard deviation; the remaining
/// error is of second order.
constexpr double kTolerance = 1e-2;
/// The same in a window, whose old poses are never linearised again.
constexpr double kWindowTolerance = 1e-6;
/// Least number of scans between solutions caused by landmarks in view, as a share of all scans.
/// The total cost of these solutions is then linear in the number of scans.
constexpr double kSpacing = 0.02;

/// How many poses a smoother keeps, and when and how it linearises.
struct SmootherSettings {
  std::size_t poses = PoseWindow::kUnlimited;
  /// Standard deviations that a landmark may move before a new solution, without a limit of poses.
  double relinearise = 0.0;
  /// Number of times that a detection is linearised again between two solutions.
  int iterations = 5;
  Jacobians jacobians = Jacobians::latest;

  bool is_limited() const { return poses != PoseWindow::kUnlimited; }
};

const std::vector<std::string> kJacobians = {"latest", "first"};

Parameter jacobians_option() {
  return choice_parameter("jacobians", "latest", kJacobians,
                          "estimates at which derivatives by the states of the prior are taken: "
                          "the latest ones, or those when the prior first contained the state");
}

/// Full smoothing (EQUATIONS 21): keeps all poses at scans and all landmarks, and linearises all
/// measurements again when the estimate has moved. Until then, the newest pose and the map, with
/// all other poses integrated out, are a Gaussian that the joint filter updates from scan to scan.
/// A scan between two solutions therefore costs as much as in EKF-SLAM.
///
/// A fixed-lag smoother (EQUATIONS 25) keeps the last poses only and marginalises the others. It
/// linearises all its measurements again at every scan.
class Smoother final : public SlamFilter {
 public:
  Smoother(const FilterSetup& setup, const SmootherSettings& settings)
      : settings_(settings),
        model_(setup.belief),
        motion_kind_(motion_of(setup.options)),
        moments_(moments_of(setup.options)),
        belief_(setup, Retraction::right_invariant, settings.iterations, moments_),
        window_(BelievedSensor(setup.belief), settings.poses, settings.jacobians) {}

  void start(const Pose& start) override {
    belief_.start({.pose = {start}});
    motion_.restart();
    window_.start(start);
    linearised_at_.clear();
    solved_poses_ = 0;
    report_ = {};
  }
  void predict(const StepContext& /*context*/, const Control& control, double duration) override {
    advance(motion_, control, duration, model_, motion_kind_);
  }
  void update(const StepContext& /*context*/, Scan scan) override {
    window_.add_pose(motion_);
    belief_.update_with(motion_, scan);
    report_update();
    belief_.initialise_landmarks(scan);
    report_.map_size = static_cast<double>(belief_.gaussian().landmarks());
    if (!settings_.is_limited()) window_.move_newest(belief_.gaussian().pose().mean);
    add_observations(scan);
    motion_.restart();
    if (settings_.is_limited() ? !belief_.used_detections().empty() : is_due()) solve();
  }
  PoseEstimate estimate() const override { return {belief_.pose_after(motion_), std::nullopt}; }
  const ScanReport& report() const override { return report_; }
  void map(std::span<std::optional<LandmarkEstimate>> landmarks) const override {
    for (std::size_t k = 0; k < landmarks.size(); ++k) landmarks[k] = belief_.landmark(k);
  }

  /// With `moments = pushed` the estimate of full smoothing is that of a separate solution, by
  /// Laplace's approximation in relative coordinates. Otherwise it is that of the Gaussian of the
  /// joint filter, and also if the solution fails, which counts as a numerical fault.
  std::optional<JointEstimate> joint(std::size_t landmarks) const override {
    if (moments_ != Moments::pushed || settings_.is_limited() || window_.graph().landmarks() == 0)
      return belief_.joint(landmarks);
    if (const auto solved = solved_joint()) {
      return joint_report(*solved, belief_.association(), landmarks, [&](std::size_t slot) {
        return slot < window_.graph().landmarks() ? 3 + row_of(slot) : Eigen::Index{-1};
      });
    }
    JointEstimate carried = belief_.joint(landmarks);
    carried.numerical_faults = 1;
    return carried;
  }

 private:
  void add_observations(Scan scan) {
    for (const JointBelief::UsedDetection& used : belief_.used_detections()) {
      const std::uint32_t landmark = belief_.association().pairings()[used.detection].landmark;
      window_.add_observation(landmark, vector_of(scan[used.detection]));
    }
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (belief_.association().pairings()[k].kind != PairingKind::fresh) continue;
      const auto landmark = static_cast<std::uint32_t>(window_.graph().landmarks());
      window_.add_observation(landmark, vector_of(scan[k]));
      linearised_at_.push_back(to_vector(window_.estimate().landmarks.back()));
    }
  }
  void report_update() {
    report_ = {};
    report_.log_likelihood = belief_.outcome().log_likelihood;
    report_.numerical_faults = belief_.outcome().faults;
    report_.association = belief_.association().counts();
    for (const JointBelief::UsedDetection& used : belief_.used_detections()) {
      if (const auto L = factor(used.covariance)) {
        report_.nis += L->whiten(used.innovation).squaredNorm();
        report_.nis_dof += static_cast<std::uint32_t>(components_of(model_.sensor).size());
      }
    }
  }

  /// Returns whether a landmark has moved so far that the graph must be solved again. Landmarks in
  /// view converge by themselves and may wait; others move when a loop closes. Far ones
  /// (CompressedGaussian) move with those near the vehicle and are not tested.
  bool is_due() const {
    const bool may_wait = static_cast<double>(window_.graph().poses() - solved_poses_) <
                          kSpacing * static_cast<double>(window_.graph().poses());
    const auto scan = window_.graph().observations_of(window_.graph().poses() - 1);
    const auto is_seen = [&](std::size_t l) {
      return std::ranges::find(scan, l, &FactorGraph::Observation::landmark) != scan.end();
    };
    for (std::size_t l = 0; l < linearised_at_.size(); ++l) {
      if (belief_.gaussian().is_near(l) && has_moved(l) && !(may_wait && is_seen(l))) return true;
    }
    return false;
  }
  bool has_moved(std::size_t landmark) const {
    const LandmarkEstimate now = belief_.gaussian().landmark(landmark);
    const auto L = factor(now.covariance);
    return L && L->whiten(now.mean - linearised_at_[landmark]).norm() > settings_.relinearise;
  }
  void solve() {
    if (!window_.solve(settings_.is_limited() ? kWindowTolerance : kTolerance)) {
      ++report_.numerical_faults;
      return;
    }
    const GraphEstimate& solved = window_.estimate();
    PoseMoments pose{solved.poses.back(), {}};
    window_.elimination().covariance(pose.covariance, map_);
    for (std::size_t l = 0; l < solved.landmarks.size(); ++l) {
      linearised_at_[l] = to_vector(solved.landmarks[l]);
      map_.mean.segment<2>(row_of(l)) = linearised_at_[l];
    }
    belief_.replace(pose, map_);
    solved_poses_ = window_.graph().poses();
  }

  /// Moments of the newest pose and the landmarks, in the order of the graph.
  std::optional<JointEstimate> solved_joint() const {
    GraphEstimate solved = window_.estimate();
    GaussNewton solver{BelievedSensor(model_)};
    if (!solver.solve(window_.graph(), kTolerance, solved)) return std::nullopt;
    return RelativeLaplace().of(window_.graph(), solved, solver.elimination());
  }

  SmootherSettings settings_;
  Belief model_;
  Motion motion_kind_;
  Moments moments_;
  JointBelief belief_;
  MotionIncrement motion_;  ///< motion since the last scan
  PoseWindow window_;
  /// {landmark} [m] position at the last solution or at a later initialisation.
  std::vector<Eigen::Vector2d> linearised_at_;
  std::size_t solved_poses_ = 0;  ///< number of poses at the last solution
  MapMoments map_;                ///< scratch
  ScanReport report_;
};

}  // namespace

FilterKind smoother_kind() {
  return {
      .name = "smoother",
      .long_name = "full smoothing",
      .source = "Dellaert, Kaess 2006; EQUATIONS 21",
      .reports = {.joint = true},
      .options = {number_parameter("relinearise", "0.5", 0, 1e9,
                                   "standard deviations that a landmark may move before everything "
                                   "is linearised again"),
                  count_parameter(
                      "iterations", "5", 0, 100,
                      "number of times that a detection is linearised again between two solutions"),
                  fitting_motion_option(), moments_option("pushed")},
      .sensors = {RangeBearingSensor::kName, PositionSensor::kName},
      .takes_mountings = true,
      .make = [](const FilterSetup& setup) {
        return std::make_unique<Smoother>(
            setup,
            SmootherSettings{.relinearise = setup.options.number("relinearise"),
                             .iterations = static_cast<int>(setup.options.integer("iterations"))});
      }};
}

FilterKind fixed_lag_smoother_kind() {
  return {.name = "fixed_lag_smoother",
          .long_name = "fixed-lag smoothing",
          .source = "Leutenegger et al. 2015; Dong-Si, Mourikis 2011; EQUATIONS 25",
          .reports = {.joint = true},
          .options = {count_parameter("lag", "10", 1, 1'000'000,
                                      "number of scans whose poses are kept and linearised again"),
                      jacobians_option(), fitting_motion_option(), moments_option("map")},
          .sensors = {RangeBearingSensor::kName, PositionSensor::kName},
          .takes_mountings = true,
          .make = [](const FilterSetup& setup) {
            const SmootherSettings settings{
                .poses = static_cast<std::size_t>(setup.options.integer("lag")),
                .jacobians = chosen<Jacobians>(setup.options.choice("jacobians"), kJacobians)};
            return std::make_unique<Smoother>(setup, settings);
          }};
}

}  // namespace montecarta::filters
