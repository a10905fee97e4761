// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/joint/joint_belief.hpp"
#include "filters/moments/control_motion.hpp"
#include "filters/setup/filter_kind.hpp"
#include "filters/smoothing/elimination.hpp"

#include <vector>

namespace montecarta::filters {

/// The maximum a posteriori estimate of all poses and landmarks (EQUATIONS 21), by Gauss-Newton in
/// relative coordinates. A step is halved as long as the sum of squares rises.
class GaussNewton {
 public:
  explicit GaussNewton(const SensorNoise& noise) : noise_(noise), elimination_(noise) {}

  /// Moves `estimate` to the least sum of squares, in at most 20 steps. It ends after a step that
  /// was predicted to lower the sum by less than `tolerance`, the square of a step in standard
  /// deviations; the elimination is linearised before that step. Returns false if landmarks are not
  /// determined or the sum is NaN; the estimate is then unchanged.
  [[nodiscard]] bool solve(const FactorGraph& graph, double tolerance, GraphEstimate& estimate);
  /// The last linearisation.
  const Elimination& elimination() const { return elimination_; }

 private:
  double squares(const FactorGraph& graph, const GraphEstimate& estimate) const;
  void move(double share, GraphEstimate& estimate) const;
  double take_step(const FactorGraph& graph, double before, GraphEstimate& estimate);

  SensorNoise noise_;
  Elimination elimination_;
  GraphMinimum minimum_;
  GraphEstimate given_, tried_;  ///< scratch
};

/// Full smoothing (EQUATIONS 21): keeps all poses at scans and all landmarks, and linearises all
/// measurements again when the estimate has moved. Until then, the newest pose and the map, with
/// all other poses integrated out, are a Gaussian that the joint filter updates from scan to scan.
/// A scan between two solutions therefore costs as much as in EKF-SLAM.
class Smoother final : public SlamFilter {
 public:
  explicit Smoother(const FilterSetup& setup);

  void start(const Pose& start) override;
  void predict(const StepContext& context, const Control& control, double duration) override;
  void update(const StepContext& context, Scan scan) override;
  PoseEstimate estimate() const override;
  const ScanReport& report() const override { return report_; }
  void map(std::span<std::optional<LandmarkEstimate>> landmarks) const override;
  /// With `moments = pushed` the estimate is that of a separate solution, by Laplace's
  /// approximation in relative coordinates. Otherwise it is that of the Gaussian of the joint
  /// filter, and also if the solution fails, which counts as a numerical fault.
  std::optional<JointEstimate> joint(std::size_t landmarks) const override;

 private:
  void add_factors(Scan scan);
  void report_update();
  bool is_due() const;
  bool has_moved(std::size_t landmark) const;
  void solve();
  std::optional<JointEstimate> solved_joint() const;

  Belief model_;
  Motion motion_kind_;
  Moments moments_;
  double share_;  ///< standard deviations that a landmark may move before a new solution
  JointBelief belief_;
  MotionIncrement motion_;  ///< since the last scan
  FactorGraph graph_;
  GraphEstimate estimate_;
  GaussNewton solver_;
  std::vector<Eigen::Vector2d> linearised_at_;  ///< {landmark} [m]
  std::size_t solved_poses_ = 0;                ///< number of poses at the last solution
  MapMoments map_;                              ///< scratch
  ScanReport report_;
};

/// Line for the table of filters.
FilterKind smoother_kind();

}  // namespace montecarta::filters
