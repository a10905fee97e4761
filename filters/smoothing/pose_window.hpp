// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/smoothing/gauss_newton.hpp"

#include <limits>

namespace montecarta::filters {

/// The graph of the last poses of a drive, with its estimate. A pose that leaves the window is
/// marginalised into the prior (EQUATIONS 25); landmarks stay.
class PoseWindow {
 public:
  static constexpr std::size_t kUnlimited = std::numeric_limits<std::size_t>::max();

  PoseWindow(const BelievedSensor& sensor, std::size_t most_poses, Jacobians jacobians)
      : sensor_(sensor), most_poses_(most_poses), solver_(sensor, jacobians) {}

  void start(const Pose& start);
  /// Adds a pose as the motion predicts it. The oldest pose is marginalised if there are now more
  /// than fit.
  void add_pose(const MotionIncrement& motion);
  /// Moves the newest pose, which is then no longer the predicted one.
  void move_newest(const Pose& pose);
  /// Adds an observation from the newest pose. A landmark with the next number is new, and placed
  /// by it.
  void add_observation(std::uint32_t landmark, const Eigen::Vector2d& observed);
  /// Does what GaussNewton::solve() does.
  [[nodiscard]] bool solve(double tolerance) { return solver_.solve(graph_, tolerance, estimate_); }

  const FactorGraph& graph() const { return graph_; }
  const GraphEstimate& estimate() const { return estimate_; }
  /// The last linearisation of solve(), until a pose is added.
  const Elimination& elimination() const { return solver_.elimination(); }

 private:
  BelievedSensor sensor_;
  std::size_t most_poses_;
  FactorGraph graph_;
  GraphEstimate estimate_;
  GaussNewton solver_;
  GraphPrior prior_;  ///< scratch
};

}  // namespace montecarta::filters
