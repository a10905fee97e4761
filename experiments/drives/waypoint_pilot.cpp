// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/drives/waypoint_pilot.hpp"

#include <algorithm>
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

double WaypointPilot::steer(const Pose& pose) {
  const Eigen::Vector2d& ahead = (*waypoints_)[next_];
  const double course = std::atan2(ahead.y() - pose.y, ahead.x() - pose.x);
  const double most = scenario_->steer_rate_limit / scenario_->control_rate;
  const double change = std::clamp(wrap(course - pose.heading - steer_), -most, most);
  steer_ = std::clamp(steer_ + change, -scenario_->steer_limit, scenario_->steer_limit);
  return steer_;
}

}  // namespace montecarta::experiments
