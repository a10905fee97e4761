// SPDX-License-Identifier: BSD-3-Clause
#include "filters/smoothing/pose_window.hpp"

namespace montecarta::filters {

void PoseWindow::start(const Pose& start) {
  graph_.start(start);
  estimate_.clear();
}

void PoseWindow::add_pose(const MotionIncrement& motion) {
  const Pose& before = estimate_.poses.empty() ? graph_.start() : estimate_.poses.back();
  graph_.add_pose(motion);
  estimate_.add_pose(graph_, motion.from(before).mean);
  estimate_.multipliers.resize(graph_.poses(), Eigen::Vector3d::Zero());
  if (graph_.poses() <= most_poses_) return;
  solver_.marginalise_first_pose(graph_, estimate_, prior_);
  graph_.replace_first_pose(prior_);
  estimate_.replace_first_pose(graph_);
}

void PoseWindow::move_newest(const Pose& pose) {
  estimate_.move_newest(pose);
  estimate_.multipliers.resize(graph_.poses() - 1);
}

void PoseWindow::add_observation(std::uint32_t landmark, const Eigen::Vector2d& observed) {
  const bool is_new = landmark == graph_.landmarks();
  graph_.add_observation(landmark, observed);
  if (!is_new) return;
  const Eigen::Vector2d place = sensor_.placed(estimate_.poses.back(), observed).point;
  estimate_.add_landmark({place.x(), place.y()});
}

}  // namespace montecarta::filters
