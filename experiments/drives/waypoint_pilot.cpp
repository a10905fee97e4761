// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/drives/waypoint_pilot.hpp"

#include <cmath>

namespace montecarta::experiments {

void WaypointPilot::look_ahead(const Pose& pose) {
  const Eigen::Vector2d& ahead = (*waypoints_)[next_];
  const double dx = ahead.x() - pose.x;
  const double dy = ahead.y() - pose.y;
  if (dx * dx + dy * dy >= scenario_->waypoint_radius * scenario_->waypoint_radius) return;
  next_ = (next_ + 1) % waypoints_->size();
  if (next_ == 0) ++loops_done_;
}

const Control& WaypointPilot::steer(const Pose& pose) {
  const Eigen::Vector2d& ahead = (*waypoints_)[next_];
  const double course = std::atan2(ahead.y() - pose.y, ahead.x() - pose.x);
  control_ = steered(scenario_->vehicle, {.before = control_,
                                          .off = course - pose.heading,
                                          .speed = scenario_->speed,
                                          .control_rate = scenario_->control_rate});
  return control_;
}

}  // namespace montecarta::experiments
