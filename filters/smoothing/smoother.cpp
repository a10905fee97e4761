// SPDX-License-Identifier: BSD-3-Clause
#include "filters/smoothing/smoother.hpp"

#include "filters/joint/joint_belief.hpp"
#include "filters/moments/control_motion.hpp"
#include "filters/smoothing/relative_laplace.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace montecarta::filters {
namespace {

constexpr int kMostSteps = 20;
constexpr int kMostStepHalvings = 10;
/// An increase of the sum by less than this share is due to rounding.
constexpr double kCostRounding = 1e-12;

/// A solution has converged if a step is less than a tenth of a standard deviation; the remaining
/// error is of second order.
constexpr double kTolerance = 1e-2;
/// Least number of scans between solutions caused by landmarks in view, as a share of all scans.
/// The total cost of these solutions is then linear in the number of scans.
constexpr double kSpacing = 0.02;

}  // namespace

bool GaussNewton::solve(const FactorGraph& graph, double tolerance, GraphEstimate& estimate) {
  given_ = estimate;
  double now = squares(graph, estimate);
  for (int step = 0; step < kMostSteps; ++step) {
    if (!elimination_.linearise(graph, estimate) || std::isnan(now)) {
      estimate = given_;
      return false;
    }
    elimination_.minimise(graph, estimate, minimum_);
    const double gain = now - minimum_.squares;
    now = take_step(graph, now, estimate);
    if (gain < tolerance) break;
  }
  return true;
}

/// The sum (21.1), infinite if newest poses have no multipliers and may be impossible to reach.
double GaussNewton::squares(const FactorGraph& graph, const GraphEstimate& estimate) const {
  if (estimate.multipliers.size() < graph.poses()) return std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (std::size_t t = 0; t < graph.poses(); ++t) {
    const Eigen::Vector3d& m = estimate.multipliers[t];
    sum += m.dot(symmetric(graph.motion(t).covariance()) * m);
    for (const auto& [landmark, observed] : graph.observations_of(t)) {
      const auto expected = sensor_.linearised(estimate.poses[t], estimate.landmarks[landmark]);
      if (!expected) continue;
      const Eigen::Vector2d off = sensor_.residual(observed, expected->value);
      sum += off(0) * off(0) / sensor_.variances()(0) + off(1) * off(1) / sensor_.variances()(1);
    }
  }
  return sum;
}

/// Moves the estimate by `share` of the way to the minimum.
void GaussNewton::move(double share, GraphEstimate& estimate) const {
  for (std::size_t t = 0; t < estimate.displacements.size(); ++t) {
    Pose& d = estimate.displacements[t];
    const Eigen::Vector3d way = share * boxminus(minimum_.displacements[t], d);
    d = {d.x + way(0), d.y + way(1), wrap(d.heading + way(2))};
    Eigen::Vector3d& m = estimate.multipliers[t];
    m += share * (minimum_.multipliers[t] - m);
  }
  for (std::size_t l = 0; l < estimate.in_frame.size(); ++l) {
    Point& p = estimate.in_frame[l];
    const Point way = minimum_.in_frame[l] - p;
    p = p + Point{share * way.x, share * way.y};
  }
}

/// Returns the sum of squares after the step. The first step of a new pose is taken in full, since
/// only then is its displacement possible for its motion.
double GaussNewton::take_step(const FactorGraph& graph, double before, GraphEstimate& estimate) {
  estimate.multipliers.resize(graph.poses(), Eigen::Vector3d::Zero());
  double share = 1.0;
  for (int halvings = 0;; ++halvings, share *= 0.5) {
    tried_ = estimate;
    move(share, tried_);
    tried_.compose(graph);
    const double after = squares(graph, tried_);
    if (after > before * (1.0 + kCostRounding) && halvings < kMostStepHalvings) continue;
    estimate = tried_;
    return after;
  }
}

namespace {

/// Full smoothing (EQUATIONS 21): keeps all poses at scans and all landmarks, and linearises all
/// measurements again when the estimate has moved. Until then, the newest pose and the map, with
/// all other poses integrated out, are a Gaussian that the joint filter updates from scan to scan.
/// A scan between two solutions therefore costs as much as in EKF-SLAM.
class Smoother final : public SlamFilter {
 public:
  explicit Smoother(const FilterSetup& setup)
      : model_(setup.belief),
        motion_kind_(motion_of(setup.options)),
        moments_(moments_of(setup.options)),
        share_(setup.options.number("relinearise")),
        belief_(setup, Retraction::invariant, static_cast<int>(setup.options.integer("iterations")),
                moments_),
        solver_(BelievedSensor(setup.belief)) {}

  void start(const Pose& start) override {
    belief_.start({.pose = {start}});
    motion_.restart();
    graph_.start(start);
    estimate_.clear();
    linearised_at_.clear();
    solved_poses_ = 0;
    report_ = {};
  }
  void predict(const StepContext& /*context*/, const Control& control, double duration) override {
    advance(motion_, control, duration, model_, motion_kind_);
  }
  void update(const StepContext& /*context*/, Scan scan) override {
    belief_.update_with(motion_, scan);
    report_update();
    belief_.initialise_landmarks(scan);
    report_.map_size = static_cast<double>(belief_.gaussian().landmarks());
    add_factors(scan);
    motion_.restart();
    if (is_due()) solve();
  }
  PoseEstimate estimate() const override { return {belief_.pose_after(motion_), std::nullopt}; }
  const ScanReport& report() const override { return report_; }
  void map(std::span<std::optional<LandmarkEstimate>> landmarks) const override {
    for (std::size_t k = 0; k < landmarks.size(); ++k) landmarks[k] = belief_.landmark(k);
  }

  /// With `moments = pushed` the estimate is that of a separate solution, by Laplace's
  /// approximation in relative coordinates. Otherwise it is that of the Gaussian of the joint
  /// filter, and also if the solution fails, which counts as a numerical fault.
  std::optional<JointEstimate> joint(std::size_t landmarks) const override {
    if (moments_ != Moments::pushed || graph_.landmarks() == 0) return belief_.joint(landmarks);
    if (const auto solved = solved_joint()) {
      return joint_report(*solved, belief_.association(), landmarks, [&](std::size_t slot) {
        return slot < graph_.landmarks() ? 3 + row_of(slot) : Eigen::Index{-1};
      });
    }
    JointEstimate carried = belief_.joint(landmarks);
    carried.numerical_faults = 1;
    return carried;
  }

 private:
  void add_factors(Scan scan) {
    graph_.add_pose(motion_);
    estimate_.add_pose(graph_, belief_.gaussian().pose().mean);
    for (const JointBelief::UsedDetection& used : belief_.used_detections()) {
      const std::uint32_t landmark = belief_.association().pairings()[used.detection].landmark;
      graph_.add_observation(landmark, vector_of(scan[used.detection]));
    }
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (belief_.association().pairings()[k].kind != PairingKind::fresh) continue;
      const std::size_t landmark = graph_.landmarks();
      const Eigen::Vector2d place = belief_.gaussian().landmark(landmark).mean;
      graph_.add_observation(static_cast<std::uint32_t>(landmark), vector_of(scan[k]));
      estimate_.add_landmark({place.x(), place.y()});
      linearised_at_.push_back(place);
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
    const bool may_wait = static_cast<double>(graph_.poses() - solved_poses_) <
                          kSpacing * static_cast<double>(graph_.poses());
    const auto scan = graph_.observations_of(graph_.poses() - 1);
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
    return L && L->whiten(now.mean - linearised_at_[landmark]).norm() > share_;
  }
  void solve() {
    if (!solver_.solve(graph_, kTolerance, estimate_)) {
      ++report_.numerical_faults;
      return;
    }
    PoseMoments pose{estimate_.poses.back(), {}};
    solver_.elimination().covariance(pose.covariance, map_);
    for (std::size_t l = 0; l < estimate_.landmarks.size(); ++l) {
      linearised_at_[l] = to_vector(estimate_.landmarks[l]);
      map_.mean.segment<2>(row_of(l)) = linearised_at_[l];
    }
    belief_.replace(pose, map_);
    solved_poses_ = graph_.poses();
  }

  /// Moments of the newest pose and the landmarks, in the order of the graph.
  std::optional<JointEstimate> solved_joint() const {
    GraphEstimate solved = estimate_;
    GaussNewton solver{BelievedSensor(model_)};
    if (!solver.solve(graph_, kTolerance, solved)) return std::nullopt;
    return RelativeLaplace().of(graph_, solved, solver.elimination());
  }

  Belief model_;
  Motion motion_kind_;
  Moments moments_;
  double share_;  ///< standard deviations that a landmark may move before a new solution
  JointBelief belief_;
  MotionIncrement motion_;  ///< motion since the last scan
  FactorGraph graph_;
  GraphEstimate estimate_;
  GaussNewton solver_;
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
      .make = [](const FilterSetup& setup) { return std::make_unique<Smoother>(setup); }};
}

}  // namespace montecarta::filters
