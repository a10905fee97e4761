// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/pose.hpp"
#include "experiments/drives/scenario.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace montecarta::experiments {

/// Steers from way-point to way-point, loop after loop (EQUATIONS 1). `waypoints` and `scenario`
/// must outlive it.
class WaypointPilot {
 public:
  WaypointPilot(const std::vector<Eigen::Vector2d>& waypoints, const Scenario& scenario)
      : waypoints_(&waypoints), scenario_(&scenario) {}

  /// Notes whether the way-point ahead is reached at `pose`; at most one a step.
  void look_ahead(const Pose& pose);
  /// The control for the next step from `pose`.
  const Control& steer(const Pose& pose);

  std::uint32_t loops_done() const { return loops_done_; }
  std::size_t next_waypoint() const { return next_; }

 private:
  const std::vector<Eigen::Vector2d>* waypoints_;
  const Scenario* scenario_;
  std::size_t next_ = 0;
  std::uint32_t loops_done_ = 0;
  Control control_;  ///< of the step before
};

}  // namespace montecarta::experiments
