// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "filters/joint/joint_belief.hpp"
#include "filters/moments/control_motion.hpp"
#include "filters/smoothing/elimination.hpp"

#include <vector>

namespace montecarta::filters {

/// The maximum a posteriori estimate of all poses and landmarks (EQUATIONS 21), by Gauss and Newton
/// in relative coordinates. A step is halved while the sum of squares rises.
class GaussNewton {
 public:
  explicit GaussNewton(const SensorNoise& noise) : noise_(noise), elimination_(noise) {}

  /// Moves `estimate` to the least sum of squares: the last step, from where the elimination was
  /// linearised, is one expected to lower it by less than `tolerance`, the square of a step in
  /// standard deviations, or the 20th. False where the landmarks are not determined or a number is
  /// none; then the estimate is what it was.
  [[nodiscard]] bool solve(const FactorGraph& graph, double tolerance, GraphEstimate& estimate);
  /// Of the last linearisation; see Elimination.
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

/// Full smoothing (EQUATIONS 21): keeps all poses at scans and all landmarks, and linearises what
/// was measured again where the estimate has moved. While a linearisation stands, the newest pose
/// and the map, all else integrated out, are a Gaussian that the joint filter carries from scan to
/// scan; so a scan between two solutions costs what EKF-SLAM costs.
class Smoother final : public SlamFilter {
 public:
  explicit Smoother(const FilterSetup& setup);

  void start(const Pose& start) override;
  void predict(const StepContext& context, const Control& control, double duration) override;
  void update(const StepContext& context, Scan scan) override;
  PoseEstimate estimate() const override;
  const ScanReport& report() const override { return report_; }
  void map(std::span<std::optional<LandmarkEstimate>> landmarks) const override;
  /// With `moments = pushed` of a solution of its own, by Laplace in relative coordinates; else,
  /// and (a numerical fault) where there is none, of the Gaussian that the next scan is conditioned
  /// on.
  std::optional<JointEstimate> joint(std::size_t landmarks) const override;

 private:
  void add_factors(Scan scan);
  void tell();
  bool is_due() const;
  bool has_moved(std::size_t landmark) const;
  void solve();
  std::optional<JointEstimate> solved_joint() const;

  Belief model_;
  Motion motion_kind_;
  Moments moments_;
  double share_;  ///< of a standard deviation that an estimate may move
  JointBelief belief_;
  MotionIncrement motion_;  ///< since the last scan
  FactorGraph graph_;
  GraphEstimate estimate_;
  GaussNewton solver_;
  std::vector<Eigen::Vector2d> linearised_at_;  ///< {landmark} [m]
  std::size_t solved_poses_ = 0;                ///< at the last solution
  MapMoments map_;                              ///< scratch
  ScanReport report_;
};

/// Its line in the table of filters.
FilterKind smoother_kind();

}  // namespace montecarta::filters
